#include "coordinator/cli/program.h"
#include "coordinator/cli/reproduce/reproduce.h"

int main(int argc, char** argv) {
  return cairn::cli::RunProgram(
      {.name = "cairn-reproduce",
       .purpose = "The papers' figures, made anew from simulated data and shown beside the papers' claims.",
       .example = "cairn-reproduce landmarks --out figures",
       .add_commands = cairn::cli::AddReproduce},
      argc, argv);
}
