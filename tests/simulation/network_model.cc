#include "tests/simulation/network_model.h"

#include <algorithm>

#include "tests/simulation/world.h"

namespace cairn::simulation {

void NetworkModel::CutOff(const std::string& peer, double until_s) {
  const std::uint64_t ways = world_.rng.Below(4);  // half of them both ways
  world_.Count(ways < 2 ? kCutOff : kCutOneWay);
  world_.Say(peer + " is cut off until " + std::to_string(until_s) + (ways < 2 ? "" : ", one way"));
  if (ways != 2) cut_until_s_[{peer, kIn}] = until_s;
  if (ways != 3) cut_until_s_[{peer, kOut}] = until_s;
}

std::vector<double> NetworkModel::Delays(const std::string& peer, Direction direction) {
  const double now_s = world_.schedule.now_s();
  const auto cut = cut_until_s_.find({peer, direction});
  if (cut != cut_until_s_.end() && now_s < cut->second) {
    world_.Count(kMessageCut);
    return {};
  }
  if (world_.Chance(world_.faults.lose)) {
    world_.Count(kMessageLost);
    return {};
  }
  std::vector<double> delays_s;
  const bool twice = world_.Chance(world_.faults.duplicate);
  if (twice) world_.Count(kMessageDoubled);
  double& latest_s = latest_s_[{peer, direction}];
  for (int i = 0; i < (twice ? 2 : 1); ++i) {
    const bool late = world_.Chance(world_.faults.late);
    if (late) world_.Count(kMessageLate);
    delays_s.push_back(late ? world_.rng.Uniform(0, 15) : world_.rng.Uniform(0.0001, world_.faults.delay_s));
    if (now_s + delays_s.back() < latest_s) world_.Count(kMessageOvertaken);
    latest_s = std::max(latest_s, now_s + delays_s.back());
  }
  return delays_s;
}

void NetworkModel::ToCoordinator(const std::string& peer, coordinator::Event event, bool whole) {
  for (const double delay_s : Delays(peer, kIn))
    world_.schedule.After(delay_s, [this, event, whole] { world_.shell().Deliver(event, whole); });
}

void NetworkModel::ToCoordinator(const std::string& peer, const wire::Fetch& fetch) {
  for (const double delay_s : Delays(peer, kIn))
    world_.schedule.After(delay_s, [this, peer, fetch] { world_.shell().Serve(peer, fetch); });
}

void NetworkModel::ToWorker(const std::string& peer, wire::Envelope message) {
  for (const double delay_s : Delays(peer, kOut))
    world_.schedule.After(delay_s, [this, peer, message] {
      if (WorkerModel* worker = world_.FindWorker(peer)) worker->Receive(message);
    });
}

}  // namespace cairn::simulation
