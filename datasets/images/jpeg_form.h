// A progressive JPEG may have scans without end, and a decoder goes over all of its pixels for each: a
// megabyte of them takes half a minute.
#pragma once

#include <string_view>

namespace cairn::datasets {

// Whether `bytes` are a JPEG of more scans than any program writes. A marker stands nowhere within a scan,
// and in what stands before it, as a thumbnail, hardly ever.
inline bool HasTooManyScans(std::string_view bytes) {
  constexpr std::string_view kJpeg = "\xFF\xD8\xFF", kScan = "\xFF\xDA";
  constexpr int kMostScans = 100;  // libjpeg's own scripts have up to 10
  if (!bytes.starts_with(kJpeg)) return false;
  int scans = 0;
  for (std::size_t at = bytes.find(kScan); at != std::string_view::npos && scans <= kMostScans;
       at = bytes.find(kScan, at + kScan.size()))
    ++scans;
  return scans > kMostScans;
}

}  // namespace cairn::datasets
