// What the tests of a landmark map's verdict share.
#pragma once

#include <cstdint>
#include <string>

#include "datasets/common/landmark_map_verdict.h"
#include "schema/blob.h"

namespace cairn::datasets {

// A map that so many of twelve starts found, so far ahead of the next different one.
inline Blob Searched(int support, double lead_nats) {
  Blob result;
  result.PutScalar<std::int32_t>("search/support", support);
  result.PutScalar<std::int32_t>("search/starts", 12);
  result.PutScalar<double>("search/lead_nats", lead_nats);
  result.Put("search/unlike", Array::Texts({}));
  return result;
}

inline std::string TextOf(const Blob& result) { return LandmarkMapVerdict(result).Text(); }

}  // namespace cairn::datasets
