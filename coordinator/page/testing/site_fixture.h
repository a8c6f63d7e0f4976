// The pages without a port or a coordinator: what they answer to one who was let in.
#pragma once

#include <gtest/gtest.h>

#include <future>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/page/site.h"

namespace cairn::page {

class FakeSource : public Source {
 public:
  FactsPtr Latest() override { return facts; }
  HistoryPtr HistoryOf(const wire::JobInfo&) override { return history; }
  void Look(const std::string& job, std::function<void()> then) override {
    looks.push_back(job);
    if (then) then();
  }
  void Command(const std::string& job, const std::string& action, int priority,
               std::function<void(const CommandOutcome&)> then) override {
    commands.push_back(job + " " + action + " " + std::to_string(priority));
    then(outcome);
  }
  static std::string Words(const ResultsOf& what) {
    return what.job + " " + std::to_string(what.stages_done);
  }
  void FetchResults(const ResultsOf& what, std::function<void(const FetchedResults&)> then) override {
    fetched.push_back(Words(what));
    then(results);
  }
  void Compare(const Compared& what, std::function<void(const FetchedResults&)> then) override {
    fetched.push_back(Words(what.one) + " beside " + Words(what.other) +
                      (what.log.empty() ? "" : " with " + what.log.string()));
    then(results);
  }
  std::shared_ptr<const FetchedResults> Fetched(const ResultsOf&) override { return nullptr; }

  std::shared_ptr<const FetchedResults> SoFar(const wire::JobInfo& job) override {
    fetched.push_back(job.id() + " so far " + job.so_far());
    return so_far;
  }

  FactsPtr facts = std::make_shared<Facts>();
  std::shared_ptr<const FetchedResults> so_far;
  HistoryPtr history;
  CommandOutcome outcome{true, "1-hall is paused."};
  FetchedResults results{
      .folder = "/cache/1", .files = {.stages = {"map"}, .has_report = true}, .picture = "map.png"};
  std::vector<std::string> looks, commands, fetched;
};

class Kept : public coordinator::HttpReply {
 public:
  void Send(coordinator::HttpAnswer told) override { answer_.set_value(std::move(told)); }  // once
  coordinator::HttpAnswer Wait() { return answer_.get_future().get(); }

 private:
  std::promise<coordinator::HttpAnswer> answer_;
};

inline wire::JobInfo Hall(const std::string& name = "hall", const std::string& state = "running") {
  wire::JobInfo job;
  job.set_id("1-hall");
  job.set_name(name);
  job.set_state(state);
  job.set_stages(2);
  job.set_stage(1);
  job.set_stage_name("map");
  return job;
}

class SiteFixture : public ::testing::Test {
 protected:
  SiteFixture() { Make({}); }
  void Make(const SiteOptions& options, const std::string& password = "") {
    site_ = std::make_shared<Site>(options,
                                   Entrance({.address = "127.0.0.1:8080", .proxy = "", .password = password},
                                            [this](const std::string& link) { link_ = link; }),
                                   source_, [this] { return now_s_; });
    const coordinator::HttpAnswer welcome = Ask("GET", "/", {{"token", link_.substr(link_.find('=') + 1)}});
    for (const auto& [name, value] : welcome.headers)
      if (name == "Set-Cookie") cookie_ = value.substr(0, value.find(';'));
    Know({Hall()});
  }
  void Know(std::vector<wire::JobInfo> jobs, const std::string& trouble = "") {
    auto facts = std::make_shared<Facts>();
    facts->number = source_->facts->number + 1;
    facts->known = true;
    facts->list->jobs = std::move(jobs);
    facts->list->may_submit = may_submit_;
    facts->utc = "12:00:00 UTC";
    facts->trouble = trouble;
    source_->facts = facts;
  }
  coordinator::HttpAnswer Ask(const std::string& method, const std::string& path,
                              std::map<std::string, std::string> query = {},
                              std::map<std::string, std::string> headers = {}, const std::string& body = "") {
    coordinator::HttpRequest request{.method = method,
                                     .path = path,
                                     .query = std::move(query),
                                     .headers = std::move(headers),
                                     .body = body};
    request.headers.try_emplace("host", "127.0.0.1:8080");
    request.headers.try_emplace("cookie", cookie_);
    const auto reply = std::make_shared<Kept>();
    site_->Answer(request, reply);
    return reply->Wait();
  }
  coordinator::HttpAnswer Get(const std::string& path) { return Ask("GET", path); }
  nlohmann::json Post(const std::string& path, const std::string& body = "") {
    return nlohmann::json::parse(Ask("POST", path, {}, {{"x-cairn", "page"}}, body).body);
  }
  static std::string HeaderOf(const coordinator::HttpAnswer& answer, const std::string& name) {
    for (const auto& [known, value] : answer.headers)
      if (known == name) return value;
    return "";
  }

  std::string link_, cookie_;
  bool may_submit_ = true;
  double now_s_ = 0;
  std::shared_ptr<FakeSource> source_ = std::make_shared<FakeSource>();
  std::shared_ptr<Site> site_;
};

}  // namespace cairn::page
