#include "coordinator/store/holder.h"

#include <unistd.h>

#include <array>
#include <charconv>
#include <fstream>
#include <sstream>
#include <utility>

#include "schema/hash.h"
#include "schema/store/atomic_file.h"
#include "schema/store/regular_file.h"
#include "schema/text.h"

namespace cairn::coordinator {
namespace {

constexpr std::size_t kMostHolderBytes = 1 << 10;
constexpr char kWhatHelps[] = "; where no other machine serves the store, ";

// One line of words, and its hash: a damaged one is nobody's.
std::string HolderLine(const Holder& holder) {
  const std::string words = std::to_string(holder.number) + (holder.serves ? " serves " : " gave-back ") +
                            holder.host + " " + holder.boot + " " + std::to_string(holder.process);
  Hasher hasher;
  hasher.Add(std::string_view(words));
  return words + " " + hasher.Finish().Hex() + "\n";
}

std::string OneWord(std::string text) {
  for (char& c : text)
    if (c <= ' ' || c > '~') c = '?';
  return text.empty() ? "?" : text;
}

std::string HostName() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? OneWord(name.data()) : "?";
}

// The system makes it up as it is read, and gives it no size.
std::string BootId() {
  std::string id;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> id;
  return OneWord(id);
}

}  // namespace

Result<Holder> ReadHolder(const std::filesystem::path& path) {
  const Result<std::string> text = ReadSmallFile(path, kMostHolderBytes);
  if (text.status().code() == Code::kNotFound) return Holder{};
  if (text.status().code() == Code::kRefused)  // no file, or another user's
    return Status(Code::kRefused, text.status().message() + kWhatHelps + "move it away");
  if (!text.ok() && text.status().code() != Code::kCorrupt) return text.status();
  Holder holder;
  std::string state;
  const std::string line = text.ok() ? text.value() : "";
  std::istringstream words(line);
  words >> holder.number >> state >> holder.host >> holder.boot >> holder.process;
  holder.serves = state == "serves";
  if (!words || holder.number == 0 || line != HolderLine(holder))
    return Status(Code::kCorrupt, path.string() + ": is damaged, so that nobody knows who serves the store" +
                                      kWhatHelps + "start with --take-over");
  return holder;
}

Status WriteHolder(const std::filesystem::path& path, const Holder& holder) {
  return WriteTextAtomically(path, HolderLine(holder));
}

Holder NextHolder(const Holder& last) {
  return {
      .number = last.number + 1, .serves = true, .host = HostName(), .boot = BootId(), .process = ::getpid()};
}

// On one machine, a container of it say, the store's lock has told already. What has started again since has
// none of its processes any more. Of two that cannot say which system they run on, nobody knows.
std::string WhyNotHold(const Holder& last, const Holder& next) {
  const bool same_boot = last.boot == next.boot && last.boot != "?";
  if (!last.serves || last.host == next.host || same_boot) return "";
  return "it was served last by " + Printable(last.host, kMostNameBytes) + " (process " +
         std::to_string(last.process) +
         "), which did not give it back: make sure that this one is off, then start with --take-over";
}

}  // namespace cairn::coordinator
