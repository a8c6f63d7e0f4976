// Other programs, run side by side: ssh to each host, the commands of a cluster.
#pragma once

#include <atomic>
#include <string>
#include <vector>

namespace cairn::coordinator {

struct Program {
  std::vector<std::string> words;  // the first is looked for in PATH
  std::string input;               // what it reads
  std::string name = {};           // in what is said of its failure; empty: the first word
  // What it leaves running in its process group is killed when it ends. (ssh leaves a master that stays.)
  bool alone = false;
};

struct ProgramOutput {
  int exit_code = -1;  // -1: it was not run, or ended by a signal, or by the limit
  std::string out, err;
  std::string failure;  // for people; empty where exit_code is 0
};

// Returns when all have ended, after `limit_s`, or once `stop` is true: what runs then is killed, with all
// that it started.
std::vector<ProgramOutput> RunPrograms(const std::vector<Program>& programs, double limit_s,
                                       const std::atomic<bool>* stop = nullptr);

// For a POSIX shell: one word, whatever is in it.
std::string ShellWord(const std::string& text);

}  // namespace cairn::coordinator
