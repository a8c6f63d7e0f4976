#include "coordinator/cli/common/programs.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "coordinator/cli/common/failure.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

// All that comes out of a pipe until its other end is closed.
std::string Drain(int fd) {
  std::string text;
  std::array<char, 4096> buffer{};
  while (true) {
    const ssize_t n = read(fd, buffer.data(), buffer.size());
    if (n > 0)
      text.append(buffer.data(), static_cast<std::size_t>(n));
    else if (n == 0 || errno != EINTR)
      return text;
  }
}

// To be read from its beginning; in memory, so that neither side waits for the other.
int FileOf(const std::string& text) {
  const int fd = memfd_create("input", MFD_CLOEXEC);
  if (fd < 0) throw WorldError(std::string("no file in memory: ") + std::strerror(errno));
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t n = write(fd, text.data() + at, text.size() - at);
    if (n < 0 && errno != EINTR) {
      close(fd);
      throw WorldError(std::string("no memory for what a program is to read: ") + std::strerror(errno));
    }
    at += n > 0 ? static_cast<std::size_t>(n) : 0;
  }
  lseek(fd, 0, SEEK_SET);
  return fd;
}

// `how`: what to do where it is missing.
std::string ProgramBesideThis(const std::string& name, const std::string& how = "") {
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error);
  if (error) throw WorldError("cannot find out where this program lies: " + error.message());
  const fs::path program = self.parent_path() / name;
  if (!fs::exists(program))
    throw WorldError(name + " is missing; it belongs beside this program: " + program.string() + how);
  return program.string();
}

int WaitFor(pid_t pid) {
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

std::string WorkerProgram() { return ProgramBesideThis("cairn-worker"); }

std::string ImagesProgram() {
  return ProgramBesideThis("cairn-images", " (Debian: the package cairn-images)");
}

std::string TagsProgram() {
  return ProgramBesideThis("cairn-tags",
                           " (Debian: the package cairn-images; built where libapriltag-dev is installed)");
}

std::string PageProgramPath() { return ProgramBesideThis("cairn-page"); }

std::string CairnProgram() { return ProgramBesideThis("cairn"); }

std::string OutputOf(const std::string& program, const std::vector<std::string>& arguments,
                     const std::optional<std::string>& input) {
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw WorldError(std::string("no pipe: ") + std::strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const int in = input ? FileOf(*input) : -1;
  if (input) posix_spawn_file_actions_adddup2(&actions, in, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  pid_t pid = 0;
  const int failed = posix_spawn(&pid, program.c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (input) close(in);
  const std::string text = failed == 0 ? Drain(ends[0]) : "";
  close(ends[0]);
  if (failed != 0) throw WorldError(program + " cannot be run: " + std::strerror(failed));
  if (WaitFor(pid) != 0) throw WorldError(program + " failed");
  return text;
}

}  // namespace cairn::cli
