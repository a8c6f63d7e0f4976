#include "coordinator/cli/output/output.h"

#include <unistd.h>

#include <cerrno>
#include <string>
#include <string_view>

#include "schema/error.h"
#include "schema/text.h"

namespace cairn::cli {
namespace {

// A descriptor, and the first bytes of a character whose others have not come yet.
struct Channel {
  int fd;
  std::string begun;
};
Channel out{STDOUT_FILENO, {}}, err{STDERR_FILENO, {}};
std::FILE* terminal = stderr;

bool WriteAll(int fd, std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = ::write(fd, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

// Where the last character begins that may yet be one; the end where all are whole, or are none.
std::size_t WholeCharacters(std::string_view text) {
  constexpr std::size_t kLongest = 4;
  for (std::size_t back = 1; back < kLongest && back <= text.size(); ++back) {
    const auto byte = static_cast<unsigned char>(text[text.size() - back]);
    if ((byte & 0xC0) == 0x80) continue;  // not the first of one
    const std::size_t needs = byte >= 0xF0 ? 4 : byte >= 0xE0 ? 3 : byte >= 0xC2 ? 2 : 1;
    return needs > back ? text.size() - back : text.size();
  }
  return text.size();
}

ssize_t Send(void* cookie, const char* bytes, std::size_t size) {
  auto& channel = *static_cast<Channel*>(cookie);
  std::string text = channel.begun + std::string(bytes, size);
  const std::size_t whole = WholeCharacters(text);
  channel.begun = text.substr(whole);
  text.resize(whole);
  return WriteAll(channel.fd, Escaped(text)) ? static_cast<ssize_t>(size) : 0;
}

std::FILE* Through(Channel& channel, int mode) {
  std::FILE* file = ::fopencookie(&channel, "w", {nullptr, Send, nullptr, nullptr});
  CAIRN_DEMAND(file != nullptr, "no stream for the output");
  CAIRN_DEMAND(std::setvbuf(file, nullptr, mode, BUFSIZ) == 0, "no buffer for the output");
  return file;
}

}  // namespace

void EscapeOutput() {
  stdout = Through(out, ::isatty(STDOUT_FILENO) != 0 ? _IOLBF : _IOFBF);
  stderr = Through(err, _IONBF);
}

bool FinishOutput() {
  bool sent = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  for (Channel* channel : {&out, &err}) {
    sent = WriteAll(channel->fd, Escaped(channel->begun)) && sent;
    channel->begun.clear();
  }
  return sent;
}

std::FILE* Terminal() { return terminal; }

}  // namespace cairn::cli
