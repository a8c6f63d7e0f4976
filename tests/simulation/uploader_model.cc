#include "tests/simulation/uploader_model.h"

#include <algorithm>
#include <utility>

#include "tests/simulation/world.h"

namespace cairn::simulation {
namespace {

constexpr double kUploadPatience_s = 300;  // once everything is healed

}  // namespace

void UploaderModel::Begin(const coordinator::SubmitJob& event) {
  const std::string peer = "client" + std::to_string(next_++);
  Client& client = clients_[peer];
  client.event = event;
  client.left = std::exchange(client.event.blobs, {});
  client.delay_s = world_.rng.Uniform(0.0005, 0.05);
  client.heard_s = began_s_ = world_.schedule.now_s();
  client.cheats = world_.Chance(world_.faults.upload_cheats);
  Offer(peer);
  if (!world_.Chance(world_.faults.upload_killed)) return;
  world_.schedule.After(world_.rng.Uniform(0, 0.5), [this, peer] {
    if (clients_.erase(peer) > 0) world_.Count(kUploaderKilled);
  });
}

void UploaderModel::Offer(const std::string& peer) {
  Client& client = clients_.at(peer);
  world_.schedule.After(client.delay_s, [this, peer] {
    const auto it = clients_.find(peer);
    if (it == clients_.end()) return;
    Client& c = it->second;
    if (c.left.empty()) {
      const coordinator::SubmitJob event = c.event;
      return world_.shell().Submit(peer, event);
    }
    c.bytes = 1 + world_.rng.Below(12);
    c.sent = c.credit = 0;
    world_.shell().Offer(peer, c.left.back(), c.bytes);
  });
}

void UploaderModel::Hear(const std::string& peer, const wire::Credit& credit) {
  const auto it = clients_.find(peer);
  if (it == clients_.end()) return;
  Client& client = it->second;
  if (credit.bytes() > 0) client.heard_s = world_.schedule.now_s();
  if (client.left.empty() || credit.hash() != client.left.back().Binary()) return;
  client.credit += credit.bytes();
  if (world_.Chance(world_.faults.upload_stops)) {
    world_.Count(kUploaderStopped);
    client.stopped_until_s = world_.schedule.now_s() + world_.rng.Uniform(0.5, 30);
  }
  if (!std::exchange(client.sending, true)) Send(peer);
}

void UploaderModel::Send(const std::string& peer) {
  Client& client = clients_.at(peer);
  const double wait_s = std::max(0.0, client.stopped_until_s - world_.schedule.now_s());
  world_.schedule.After(wait_s + client.delay_s, [this, peer] {
    const auto it = clients_.find(peer);
    if (it == clients_.end()) return;
    Client& c = it->second;
    const bool cheats = c.cheats && world_.rng.Below(8) == 0;
    c.sending = !c.left.empty() && c.sent < c.bytes && (c.credit > 0 || cheats);
    if (!c.sending) return;
    if (cheats) world_.Count(kUploaderCheated);
    wire::Piece piece;
    piece.set_hash(c.left.back().Binary());
    piece.set_at(c.sent);
    const std::uint64_t more = cheats ? c.credit + 20 : std::min(c.credit, 1 + world_.rng.Below(3));
    piece.set_data(std::string(cheats ? more : std::min(more, c.bytes - c.sent), 'x'));
    c.sent += piece.data().size();
    c.credit -= std::min(c.credit, static_cast<std::uint64_t>(piece.data().size()));
    world_.shell().Bring(peer, std::move(piece));
    if (clients_.contains(peer)) Send(peer);
  });
}

void UploaderModel::Hear(const coordinator::AnswerOffer& answer) {
  const auto it = clients_.find(answer.peer);
  if (it == clients_.end() || it->second.left.empty()) return;
  Client& client = it->second;
  client.heard_s = world_.schedule.now_s();
  if (answer.refusal.empty()) {
    world_.Count(kUploaded);
    client.left.pop_back();
    return Offer(answer.peer);
  }
  world_.Count(answer.again ? kUploadGivenUp : kUploadRefused);
  if (answer.again)
    Offer(answer.peer);
  else
    clients_.erase(it);  // its user will try again
}

void UploaderModel::CheckThatTheyMove() {
  const bool all_quiet = world_.healed() && world_.schedule.now_s() - began_s_ > 6 * kUploads.silent_s;
  if (all_quiet && world_.shell().KeepsForClients())
    world_.checks.Fail("what no job took is kept, though its client is long gone");
  for (const auto& [peer, client] : clients_)
    if (world_.healed() && !client.left.empty() &&
        world_.schedule.now_s() - client.heard_s > kUploadPatience_s)
      world_.checks.Fail(peer + " waits with its upload, and nobody says why");
}

}  // namespace cairn::simulation
