// Messages between workers and the coordinator: lost, doubled, late, overtaken, or cut off by a partition.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/core/events.h"

namespace cairn::simulation {

class World;

class NetworkModel {
 public:
  explicit NetworkModel(World& world) : world_(world) {}
  // `whole`: see ShellModel::Deliver.
  void ToCoordinator(const std::string& peer, coordinator::Event event, bool whole = true);
  void ToCoordinator(const std::string& peer, const wire::Fetch& fetch);
  void ToWorker(const std::string& peer, wire::Envelope message);
  // Both ways, or one of them.
  void CutOff(const std::string& peer, double until_s);
  void Heal() { cut_until_s_.clear(); }

 private:
  enum Direction { kIn, kOut };
  // When one message comes: each is one delivery, none is a loss.
  std::vector<double> Delays(const std::string& peer, Direction direction);

  World& world_;
  std::map<std::pair<std::string, Direction>, double> cut_until_s_;
  std::map<std::pair<std::string, Direction>, double> latest_s_;  // delivery so far
};

}  // namespace cairn::simulation
