// A worker whose only pipeline is the toy, with tasks that take long enough to be caught in the middle of
// one: milliseconds from the environment variable CAIRN_TASK_MS.
#include <chrono>
#include <cstdlib>
#include <memory>
#include <thread>
#include <utility>

#include "worker/program.h"
#include "worker/testing/toy_pipeline.h"

namespace cairn {
namespace {

class Slowed : public Pipeline {
 public:
  Slowed(std::unique_ptr<const Pipeline> inner, int task_ms) : inner_(std::move(inner)), task_ms_(task_ms) {}
  Step Start(const Inputs& inputs) const override { return inner_->Start(inputs); }
  Blob Run(const Task& task, const Inputs& inputs, Progress& progress) const override {
    for (int i = 0; i < task_ms_; ++i) {
      progress.Tick();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return inner_->Run(task, inputs, progress);
  }
  Step Advance(const State& state, Partials& partials, const Inputs& inputs) const override {
    return inner_->Advance(state, partials, inputs);
  }

 private:
  const std::unique_ptr<const Pipeline> inner_;
  const int task_ms_;
};

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) {
  const char* task_ms = std::getenv("CAIRN_TASK_MS");
  const int ms = task_ms == nullptr ? 0 : std::atoi(task_ms);
  return cairn::worker::WorkerProgram(
      argc, argv, {cairn::testing::ToyInfo()}, [ms](const cairn::proto::Stage& stage, std::uint64_t seed) {
        return std::unique_ptr<const cairn::Pipeline>(
            std::make_unique<cairn::Slowed>(cairn::testing::MakeToy(stage, seed), ms));
      });
}
