// A worker program for the suite: all registered pipelines, and the toy.
#include "tests/conformance/cases.h"
#include "worker/program.h"

int main(int argc, char** argv) {
  return cairn::worker::WorkerProgram(argc, argv, cairn::conformance::ListAll(), cairn::conformance::Make);
}
