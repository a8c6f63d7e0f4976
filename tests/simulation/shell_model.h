// The coordinator's shell without sockets and files: carries out the core's actions against a model of memory
// and disk, dies, and comes back with what was durable.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core.h"
#include "tests/simulation/toy.h"

namespace cairn::simulation {

class World;

class ShellModel {
 public:
  explicit ShellModel(World& world) : world_(world) {}
  void Start();
  void Submit(const std::string& id, const proto::Job& job);
  void Deliver(const coordinator::Event& event);  // lost while the coordinator is down
  void Crash(double down_s);
  void ResumeIfStopped(const std::string& id);
  // Whether a worker that was given `key` could fetch its inputs. A task that is still wanted must have them.
  bool Serves(const wire::TaskKey& key, const std::string& peer, const std::set<Hash>& blobs);
  bool AllEnded(const std::vector<std::string>& ids) const;
  void CheckEnd(const std::vector<std::string>& ids);
  std::string Summary() const;

 private:
  using Checkpoints = std::map<std::uint64_t, proto::Checkpoint>;  // of a job, by number
  void TickOn();
  void Restart();
  void Restore(const std::string& id, Checkpoints& checkpoints);
  void Apply(const coordinator::Action& action);
  void Do(const coordinator::Send& send);
  void Do(const coordinator::Persist& persist);
  void Do(const coordinator::DropBlobs& drop);
  void Do(const coordinator::JobChanged&) {}
  void Do(const coordinator::Report& report);
  void EndPersist(const coordinator::Persist& persist, bool tell);
  void CheckAssign(const wire::Assign& assign);
  void CheckMemory();

  World& world_;
  std::unique_ptr<coordinator::Core> core_;  // null while it is down
  std::uint64_t incarnation_ = 0;
  std::map<std::string, proto::Job> submitted_;
  std::set<std::string> accepted_;  // submissions that were answered: durable
  std::set<Hash> memory_;
  // What survives a crash.
  std::map<std::string, Checkpoints> checkpoints_;
  std::set<Hash> disk_;
};

}  // namespace cairn::simulation
