#include "coordinator/cli/app.h"

int main(int argc, char** argv) { return cairn::cli::Main(argc, argv); }
