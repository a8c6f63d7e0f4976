// What is answered to each request: who may, which page, and with which headers.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "coordinator/http/http_server.h"
#include "coordinator/page/entrance.h"
#include "coordinator/page/source.h"
#include "coordinator/page/start.h"
#include "coordinator/page/views.h"

namespace cairn::page {

struct SiteOptions {
  bool read_only = false;  // nobody commands a job from here
  std::string foot = {};   // under each page: whose coordinator it shows
  Desk* desk = nullptr;    // where jobs are started from here; outlives the site
};

class Site : public std::enable_shared_from_this<Site> {
 public:
  // `now_s`: a clock that never goes back.
  Site(SiteOptions options, Entrance entrance, std::shared_ptr<Source> source, std::function<double()> now_s);

  // On the thread of the server.
  void Answer(const coordinator::HttpRequest& request, const std::shared_ptr<coordinator::HttpReply>& reply);

  // The same of what has yet to come: files alone are taken, of whoever may start a job.
  std::variant<std::shared_ptr<coordinator::HttpUpload>, coordinator::HttpAnswer> BeginUpload(
      const coordinator::HttpRequest& request);

  static constexpr unsigned kMostStreams = 256;  // that look on, of all sessions
  // From now on streams end with this sentence.
  void End(const std::string& why);
  // Whether a page was sent a moment ago that has not begun to listen yet: it is to hear that, too.
  bool AwaitsListeners();

 private:
  friend class PartsStream;
  using Reply = std::shared_ptr<coordinator::HttpReply>;

  void AnswerStranger(const coordinator::HttpRequest& request, const Reply& reply);
  void AnswerGet(const coordinator::HttpRequest& request, const Reply& reply);
  void AnswerJob(const std::string& job, const std::string& what, const Reply& reply);
  void AnswerComparison(const coordinator::HttpRequest& request, const Reply& reply);
  void AnswerSoFar(const wire::JobInfo& job, const Reply& reply);
  void AnswerFile(const wire::JobInfo& job, const std::string& what, const Reply& reply);
  void AnswerPost(const coordinator::HttpRequest& request, const Reply& reply);
  void AnswerStart(const coordinator::HttpRequest& request, const Reply& reply);
  void AnswerEvents(const coordinator::HttpRequest& request, const Reply& reply);
  coordinator::HttpAnswer PageOf(const View& view);
  std::shared_ptr<const Parts> PartsFor(const View& view);
  bool MayCommand(const wire::JobInfo* job) const;
  // Why who looks on starts no job from here; empty: he may.
  std::string WhyNoStart() const;
  std::string Farewell();
  void LookUnlessOver(const std::string& job, std::function<void()> then);
  void NotePage(const coordinator::HttpRequest& request);
  void NoteListener(const coordinator::HttpRequest& request);

  SiteOptions options_;
  Entrance entrance_;
  std::shared_ptr<Source> source_;
  std::function<double()> now_s_;
  std::shared_ptr<StartPages> start_;  // null: none is started from here
  // Of the thread of the server: what the streams of a session hold, by its token.
  std::map<std::string, std::weak_ptr<int>> seats_;

  struct Made {
    FactsPtr of;
    HistoryPtr history;
    bool fetched;
    std::string so_far;
    std::shared_ptr<const Parts> parts;
  };
  std::mutex mutex_;                  // of all below
  std::map<std::string, Made> made_;  // by the address of the page: made once for all who look on
  std::string farewell_;
  std::vector<std::pair<std::string, double>> awaited_;  // whose session's page was sent when
};

}  // namespace cairn::page
