// cairn-worker: computes tasks for a coordinator. The only program that runs science.
#include "pipelines/registry.h"
#include "worker/program.h"

int main(int argc, char** argv) {
  return cairn::worker::WorkerProgram(argc, argv, cairn::ListPipelines(), cairn::MakePipeline);
}
