#include "coordinator/server/on_its_way.h"

#include <algorithm>
#include <utility>

namespace cairn::coordinator {

OnItsWay::Peer& OnItsWay::PeerOf(const std::string& peer) {
  Peer& of = peers_[peer];
  of.unsent_bytes = transport_.Unsent(peer);
  return of;
}

void OnItsWay::Add(const std::string& peer, To to, const std::string& user, const std::string& what) {
  Peer& of = PeerOf(peer);
  of.to = to;
  of.user = user;
  of.what = what;
}

void OnItsWay::AddAnswer(const std::string& peer, const std::string& user) {
  if (transport_.Unsent(peer) > 0 && !peers_.contains(peer)) Add(peer, To::kQuestions, user, peer);
}

void OnItsWay::AddFetched(const std::string& worker, const std::string& fetch, std::uint64_t bytes,
                          bool copied) {
  Peer& of = PeerOf(worker);
  of.answers.push_back({fetch, bytes, copied});
  of.answers_bytes += bytes;
  copied_bytes_ += copied ? bytes : 0;
}

// They go in the order in which they were sent.
void OnItsWay::ForgetWhatIsOut(Peer& of, std::size_t unsent_bytes) {
  while (!of.answers.empty() && of.answers_bytes - of.answers.front().bytes >= unsent_bytes) {
    of.answers_bytes -= of.answers.front().bytes;
    of.answers.pop_front();
  }
}

bool OnItsWay::HasFetched(const std::string& worker, const std::string& fetch) {
  const auto it = peers_.find(worker);
  if (it == peers_.end()) return false;
  ForgetWhatIsOut(it->second, transport_.Unsent(worker));
  return std::ranges::any_of(it->second.answers,
                             [&](const Peer::Answer& answer) { return answer.fetch == fetch; });
}

std::uint64_t OnItsWay::Bytes(To to, const std::string& what) const {
  std::map<std::string, std::uint64_t> most;
  for (const auto& [peer, of] : peers_)
    if (of.to == to && of.what != what)
      most[of.what] = std::max<std::uint64_t>(most[of.what], transport_.Unsent(peer));
  std::uint64_t bytes = 0;
  for (const auto& [of, unsent] : most) bytes += unsent;
  return bytes;
}

std::uint64_t OnItsWay::BytesOf(const std::string& user) const {
  std::uint64_t bytes = 0;
  for (const auto& [peer, of] : peers_)
    if (of.user == user && of.to != To::kWorkers && of.to != To::kQuestions) bytes += transport_.Unsent(peer);
  return bytes;
}

std::uint64_t OnItsWay::AnswerBytesOf(const std::string& user) const {
  std::uint64_t bytes = 0;
  for (const auto& [peer, of] : peers_)
    if (of.user == user && of.to == To::kQuestions) bytes += transport_.Unsent(peer);
  return bytes;
}

std::vector<std::string> OnItsWay::Look(double now_s) {
  constexpr double kMost_s = 1;  // that counts between two looks: this process may have been stopped, too
  const double since_s = std::min(now_s - std::exchange(looked_s_, now_s), kMost_s);
  std::vector<std::string> stalled;
  copied_bytes_ = 0;
  for (auto it = peers_.begin(); it != peers_.end();) {
    Peer& of = it->second;
    const std::size_t unsent = transport_.Unsent(it->first);
    of.idle_s = unsent < of.unsent_bytes ? 0 : of.idle_s + since_s;
    of.unsent_bytes = unsent;
    const bool is_stalled = unsent > 0 && of.idle_s > patience_s_;
    if (is_stalled) stalled.push_back(it->first);
    ForgetWhatIsOut(of, unsent);
    for (const Peer::Answer& answer : of.answers) copied_bytes_ += answer.copied ? answer.bytes : 0;
    it = is_stalled || unsent == 0 ? peers_.erase(it) : std::next(it);
  }
  return stalled;
}

}  // namespace cairn::coordinator
