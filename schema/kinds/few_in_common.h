// The moment of a robot's way at which what it saw before and what it saw after have the least in common.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cairn {

struct FewInCommon {
  std::size_t common = 0, of = 0;  // of the landmarks on the side that has fewer; 0: there is no such moment
  std::size_t robot = 0, number = 0;  // after which of its observations, from 1 on
  bool IsLessThan(const FewInCommon& other) const {
    return other.of == 0 || common * other.of < other.common * of;
  }
  // No more than half of them.
  bool AreFew() const { return of > 0 && 2 * common <= of; }
};

// Of three landmarks or more, but for the first and the last tenth of a robot's observations of landmarks;
// what another robot saw of both sides ties them, too. `landmarks`: of each robot, which landmark each of its
// observations is of, -1: none.
FewInCommon FindFewestInCommon(const std::vector<std::span<const std::int32_t>>& landmarks);

}  // namespace cairn
