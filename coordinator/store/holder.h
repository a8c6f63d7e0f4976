// DIR/holder: which coordinator serves a store, for file systems that several machines see and whose locks
// may fail: a lock may hold on one machine alone, or be lost while its owner's machine is cut off. Each
// coordinator that begins to serve writes itself there under the next number, and looks before each write
// whether it still stands there. One that comes back after another has taken the store over so finds out, and
// writes nothing more.
//
// Looked at between two writes: what the first was writing at the very moment may still come. No file of a
// store is changed in place, and a checkpoint's number is never that of another machine's newest, so that
// costs at most what the next start finds damaged and makes up for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "schema/error.h"

namespace cairn::coordinator {

struct Holder {
  std::uint64_t number = 0;  // 0: nobody ever was
  bool serves = false;       // it did not give the store back
  std::string host, boot;    // of its machine; /proc/sys/kernel/random/boot_id
  std::int64_t process = 0;

  bool operator==(const Holder&) const = default;
};

// Of a folder without such a file one of number 0. kCorrupt: what is there is none. kRefused: no file, or one
// that this user may not read. Both say what helps.
Result<Holder> ReadHolder(const std::filesystem::path& path);
// Durable when it returns.
Status WriteHolder(const std::filesystem::path& path, const Holder& holder);

// This process, under the number after `last`.
Holder NextHolder(const Holder& last);

// Why `next` must not begin by itself where `last` was the holder: another machine's, which no lock tells of
// and which did not give the store back. Empty: it may.
std::string WhyNotHold(const Holder& last, const Holder& next);

}  // namespace cairn::coordinator
