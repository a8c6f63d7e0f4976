// The pages on which a job is started: what is answered to each request of those who may.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "coordinator/http/http_server.h"
#include "coordinator/page/desk.h"

namespace cairn::page {

// For any thread. `token`: that his forms have with them who asks (Entrance::FormToken).
class StartPages : public std::enable_shared_from_this<StartPages> {
 public:
  using Reply = std::shared_ptr<coordinator::HttpReply>;

  // `desk` outlives it.
  StartPages(Desk* desk, std::string foot) : desk_(desk), foot_(std::move(foot)) {}

  // /new, /new?job=2-hall, /new/3, /new/3/landmark_map
  void Get(const coordinator::HttpRequest& request, const std::string& token, const Reply& reply);
  // /new/upload, /new/from-job, /new/3/remove, /new/3/landmark_map. Whether it is his own form was looked at.
  void Post(const coordinator::HttpRequest& request, const std::string& token, const Reply& reply);
  // Of /new/upload, before it comes.
  std::shared_ptr<coordinator::HttpUpload> Begin(const coordinator::HttpRequest& request);

 private:
  struct Place;
  // Of "/new/3/landmark_map"; kind and file are looked up.
  bool Find(const std::string& path, Place* place);
  coordinator::HttpAnswer FilesPage(unsigned code, const std::string& token, const std::string& trouble,
                                    const std::string& job = "");
  void AnswerOrder(const Place& place, std::map<std::string, std::string> values, const std::string& token,
                   const Reply& reply);
  coordinator::HttpAnswer PageOf(unsigned code, const std::string& title, const std::string& main) const;

  Desk* desk_;
  std::string foot_;
};

}  // namespace cairn::page
