// Time slices side by side: once the map is sharp a belief soon forgets where it began, so that a slice is
// computed from guesses of the tables at its ends while its neighbours are. What was guessed right is kept,
// the rest computed again.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/common/layered_grid.h"
#include "pipelines/landmark_map/state/schedule.h"

namespace cairn::landmark_map {

// What a robot's slices in one round tell of those in the next.
struct Guesses {
  std::vector<std::int32_t> first;  // [slices] first steps, ascending; the first one is 0
  // [slices]: alpha of the step that lies `overlap` + 1 before the slice's first, as the task before stored
  // it (LayeredGrid::StoreSparse): only a task that begins from it looks whether it is one. Without fields
  // where the slice before is too short to have it.
  std::vector<Blob> warm;

  // The partial of the robot's task `backward` of the slice before those so far: the last slice's comes
  // first, and what a slice leaves is for the one after it.
  void AddEarlier(const Blob& partial);
  Blob ToBlob() const;
  // Throws InputError where an array is missing or does not fit the others.
  static Guesses FromBlob(const Blob& blob);
};

// Their names in the State begin with this; a robot's number follows.
inline constexpr const char* kGuesses = "guesses/";

// How many steps before a slice a guess begins, and how many behind it a guess of beta does, at first.
inline constexpr std::int64_t kOverlap = 32;

// Iterations on all data after which the map is sharp enough for slices to be guessed.
inline constexpr std::int64_t kSharpAfter = 2;

// Which slices of a robot's next round, of `steps` steps in all, are worth guessing: once the map is sharp,
// those that are at least twice as long as the overlap. None where it would
// be the first one alone, which waits for nobody.
std::vector<bool> WorthGuessing(const Guesses& guesses, std::int64_t steps, std::int64_t overlap,
                                const Schedule& next);

// Whether so many of a robot's slices were guessed wrong that a longer overlap is called for.
bool TooShort(std::int64_t guessed, std::int64_t confirmed);

// Whether a guessed table is the true one: both have the same support, and no two probabilities of a place
// differ by more than 1e-7 of themselves. Closeness in total variation would not do: a place that is missing
// may win later.
bool Agree(const LayeredGrid& guess, const LayeredGrid& truth);

}  // namespace cairn::landmark_map
