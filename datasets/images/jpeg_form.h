// What a decoder does not tell of a JPEG, by its markers alone.
#pragma once

#include <cstddef>
#include <string_view>

namespace cairn::datasets {

inline constexpr std::string_view kJpeg = "\xFF\xD8\xFF";

// Whether `bytes` are a JPEG of more scans than any program writes. A progressive one may have scans without
// end, and a decoder goes over all of its pixels for each: a megabyte of them takes half a minute. A marker
// stands nowhere within a scan, and in what stands before it, as a thumbnail, hardly ever.
inline bool HasTooManyScans(std::string_view bytes) {
  constexpr std::string_view kScan = "\xFF\xDA";
  constexpr int kMostScans = 100;  // libjpeg's own scripts have up to 10
  if (!bytes.starts_with(kJpeg)) return false;
  int scans = 0;
  for (std::size_t at = bytes.find(kScan); at != std::string_view::npos && scans <= kMostScans;
       at = bytes.find(kScan, at + kScan.size()))
    ++scans;
  return scans > kMostScans;
}

// Whether `bytes` are a JPEG that ends before its end marker: a decoder fills what is missing with grey.
// Segments are passed over by their lengths, for a thumbnail in one has an end of its own.
inline bool BreaksOff(std::string_view bytes) {
  constexpr unsigned char kEnd = 0xD9, kStart = 0xD8, kFirstRestart = 0xD0, kTemporary = 0x01;
  if (!bytes.starts_with(kJpeg)) return false;
  const auto byte = [bytes](std::size_t at) { return static_cast<unsigned char>(bytes[at]); };
  for (std::size_t at = 2;;) {
    at = bytes.find_first_not_of('\xFF', bytes.find('\xFF', at));  // any number of them leads a marker in
    if (at >= bytes.size()) return true;
    const unsigned char marker = byte(at++);
    if (marker == kEnd) return false;
    // A 0 says that what stands before it is none.
    if (marker <= kTemporary || (marker >= kFirstRestart && marker <= kStart)) continue;
    if (bytes.size() - at < 2) return true;
    at += std::size_t{byte(at)} << 8 | byte(at + 1);
    if (at > bytes.size()) return true;
  }
}

}  // namespace cairn::datasets
