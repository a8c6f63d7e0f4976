// Whose turn it is: jobs that have tasks to give share the workers by the seconds of work that they were
// given. A job of priority p gets 2^p times what a job of priority 0 gets. Every turn costs, so nobody
// starves; who had nothing to give for a while has saved nothing up. (Start-time fair queueing: Goyal, Vin,
// Cheng 1997.)
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace cairn::coordinator {

class FairShare {
 public:
  // Jobs by their order; of equal claims the first goes first.
  void Offer(std::uint64_t job);     // it has a task to give
  void Withdraw(std::uint64_t job);  // it has none
  void Forget(std::uint64_t job);    // for good
  std::optional<std::uint64_t> Next() const;
  // The job that is next was given work of about so many worker seconds.
  void Charge(std::uint64_t job, double seconds, int priority);
  // Where it is higher now, what the job was given counts as if it had been so from the beginning: it need
  // not wait for what weighed more. Where it is lower the next turn weighs more.
  void Reprioritize(std::uint64_t job, int before, int priority);

 private:
  std::map<std::uint64_t, double> clocks_;            // what each was given, divided by its share
  std::set<std::pair<double, std::uint64_t>> ready_;  // by clock
  double now_ = 0;                                    // the clock of whoever was served last, when it was
};

}  // namespace cairn::coordinator
