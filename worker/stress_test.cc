// Many schedules of a capricious coordinator: tasks are cancelled, connections lost, blobs withheld, in any
// order. What must hold: every task of the last connection that was not cancelled is answered once, and
// rightly.
#include <gtest/gtest.h>

#include <set>

#include "schema/rng.h"
#include "worker/testing/rig.h"

namespace cairn::worker {
namespace {

// The sum of the inputs, and the index.
Blob Sum(const Task& task, const Inputs& inputs, Progress& progress) {
  double sum = task.index();
  for (const proto::InputRef& ref : task.inputs()) {
    progress.Tick();
    sum += inputs.Get(ref.name())->Scalar<double>("v");
  }
  return Number(sum);
}

class Caprice {
 public:
  explicit Caprice(std::uint64_t seed)
      : rng_(seed),
        rig_(Sum, [](WorkerOptions& o) { o.session.cache_bytes = 5 * BlobCache::Footprint(Number(0)); }) {
    for (int i = 0; i < 12; ++i) hashes_.push_back(rig_.Keep(Number(i * 1000)));
    rig_.Begin(1000);
  }
  void Play(int steps) {
    for (int i = 0; i < steps; ++i) {
      const std::uint64_t dice = rng_.Below(20);
      if (dice < 10)
        Assign();
      else if (dice < 14)
        Cancel();
      else if (dice < 19)
        TakeOne();
      else
        Break();
    }
    while (!open_.empty()) TakeOne();
  }
  int answers() const { return answers_; }

 private:
  void Assign() {
    std::map<std::string, Hash> inputs;
    double sum = next_;
    for (std::uint64_t i = rng_.Below(4); i > 0; --i) {
      const std::uint64_t which = rng_.Below(hashes_.size());
      sum += static_cast<double>(which) * 1000;
      inputs[std::to_string(i)] = hashes_[which];
    }
    rig_.Assign(RunTask(next_, inputs));
    open_[next_++] = sum;
  }
  void Cancel() {
    if (open_.empty()) return;
    auto it = open_.begin();
    std::advance(it, static_cast<std::ptrdiff_t>(rng_.Below(open_.size())));
    rig_.Cancel(RunTask(it->first).key());
    cancelled_.insert(it->first);
    open_.erase(it);
  }
  // An answer to an open task; answers that crossed a Cancel are passed over.
  void TakeOne() {
    if (open_.empty()) return;
    while (true) {
      const wire::Message answer = rig_.Serve();
      ASSERT_TRUE(answer.envelope.has_done()) << answer.envelope.DebugString();
      const std::uint32_t task = answer.envelope.done().key().task();
      if (cancelled_.erase(task) > 0) continue;
      ASSERT_TRUE(open_.contains(task)) << "an answer to nobody's question, or a second one: " << task;
      EXPECT_EQ(answer.blobs.at(0).blob->Scalar<double>("v"), open_.at(task));
      open_.erase(task);
      ++answers_;
      return;
    }
  }
  // The connection is lost and comes back. What was said before Hello is of the connection before.
  void Break() {
    rig_.Give(Event::kDisconnected);
    rig_.Give(Event::kConnected);
    while (!rig_.transport.Take().envelope.has_hello()) {
    }
    wire::Message welcome;
    welcome.envelope.mutable_welcome()->set_heartbeat_s(1000);
    rig_.Give(welcome);
    open_.clear();
    cancelled_.clear();
  }

  Rng rng_;
  Rig rig_;
  std::vector<Hash> hashes_;
  std::uint32_t next_ = 0;
  std::map<std::uint32_t, double> open_;  // task -> what its answer must say
  std::set<std::uint32_t> cancelled_;     // in this connection
  int answers_ = 0;
};

TEST(WorkerStress, EveryOpenTaskIsAnsweredOnceWhateverTheCoordinatorDoes) {
  int answers = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Caprice caprice(seed);
    caprice.Play(300);
    if (HasFatalFailure()) return;
    answers += caprice.answers();
  }
  EXPECT_GT(answers, 2000);
}

}  // namespace
}  // namespace cairn::worker
