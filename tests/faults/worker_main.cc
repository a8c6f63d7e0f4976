// A worker of all registered pipelines, and the toy, that can be slowed and made to hang: slowed.h.
#include "tests/conformance/cases.h"
#include "tests/faults/slowed.h"
#include "worker/program.h"

int main(int argc, char** argv) {
  return cairn::worker::WorkerProgram(
      argc, argv, cairn::conformance::ListAll(),
      [](const cairn::proto::Stage& stage, std::uint64_t seed) -> std::unique_ptr<const cairn::Pipeline> {
        return std::make_unique<cairn::faults::Slowed>(cairn::conformance::Make(stage, seed));
      });
}
