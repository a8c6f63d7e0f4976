// What whoever watches the service asks of it.
#include "coordinator/server/server.h"

namespace cairn::coordinator {
namespace {

constexpr double kServedEvery_s = 60;   // so much of a job's age a crash may lose
constexpr double kTroubledEvery_s = 1;  // while the store cannot be written

}  // namespace

// The store can be written where the time served could be written last, a line that has to be written anyway:
// the sooner, the more there is to doubt it. A disk that hangs takes nothing more to do, and fails none.
void Server::ProbeStore(double now_s) {
  const double since_s = now_s - served_written_s_;
  const bool doubt = probe_soon_ || !store_trouble_.empty();
  if (!writer_.Finished(served_ticket_)) {
    if (since_s >= kServedEvery_s) store_trouble_ = "the disk has not taken anything for a minute";
  } else if (since_s >= (doubt ? kTroubledEvery_s : kServedEvery_s)) {
    probe_soon_ = false;
    WriteServed();
  }
}

void Server::TakeProbe(const Status& status) {
  if (status.ok() && !store_trouble_.empty()) log_(Severity::kInfo, "the store can be written again");
  store_trouble_ = status.message();
}

std::string Server::Warning() const {
  std::string keys = access_control_.Warning();
  if (const std::string ending = access_control_.EndWarning(); !ending.empty())
    keys += (keys.empty() ? "" : "; ") + ending;
  if (store_trouble_.empty()) return keys;
  return "the store cannot be written: " + store_trouble_ + (keys.empty() ? "" : "; " + keys);
}

Metrics Server::TakeMetrics() const {
  Metrics metrics;
  metrics.version = options_.core.build.version();
  metrics.compiler = options_.core.build.compiler();
  metrics.census = core_.TakeCensus();
  metrics.tally = core_.tally();
  metrics.turns = turns_;
  metrics.traffic = transport_.TotalTraffic();
  metrics.refused = refusals_.Counts();
  metrics.store_bytes = use_.bytes();
  metrics.store_limit_bytes = use_.limit_bytes();
  metrics.store_blobs = blobs_.size();
  metrics.store_writable = store_trouble_.empty();
  metrics.last_checkpoint_utc_s = last_checkpoint_utc_s_;
  return metrics;
}

}  // namespace cairn::coordinator
