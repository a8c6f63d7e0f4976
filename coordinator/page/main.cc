// cairn-page: pages to watch jobs with, and to command them, over HTTP. A client of the coordinator as any
// other: if it hangs, crashes or is attacked, no job notices.
#include "coordinator/page/program.h"

int main(int argc, char** argv) { return cairn::page::PageProgram(argc, argv); }
