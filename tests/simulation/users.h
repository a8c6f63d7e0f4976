// Users: submit jobs at any moment, submit them again, cancel, resume, and give up.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "coordinator/core/core.h"
#include "tests/simulation/toy.h"

namespace cairn::simulation {

class World;

class Users {
 public:
  explicit Users(World& world) : world_(world) {}
  void Start();
  // Every second: while there is trouble, and once everything is healed.
  void Disturb();
  void BringToAnEnd();
  const std::vector<std::string>& jobs() const { return ids_; }  // those that were submitted
  bool Deleted(const std::string& id) const { return wishes_.at(id).deleted; }
  // Every job is done, or has ended as it must; and all of it is saved.
  bool AllEnded() const;
  void CheckEnd() const;
  std::string Summary() const;

 private:
  struct Wish {
    proto::Job job;
    ToyKind kind = ToyKind::kGood;
    bool given_up = false;  // cancelled
    bool deleted = false;
    int resumed = 0;  // since all is healed
    // How it stood when it was last seen to move, and when that was.
    std::tuple<std::uint32_t, std::uint64_t, std::size_t, int, std::uint64_t> stood;
    double moved_s = 0;
  };
  void Wants(ToyKind kind);
  void Submit(const std::string& id);
  void Cancel(const std::string& id, Wish& wish);
  void Pause(const std::string& id);
  void Delete(const std::string& id, Wish& wish);
  void ResumeIfStopped(const std::string& id);
  bool IsOver(const coordinator::Job& job, const Wish& wish) const;
  void CheckThatItMoves(const std::string& id, Wish& wish);

  World& world_;
  std::map<std::string, Wish> wishes_;
  std::vector<std::string> ids_;
};

}  // namespace cairn::simulation
