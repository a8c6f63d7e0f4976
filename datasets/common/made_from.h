// Whether a result is held against the log that it was made from, or against a result of the same log.
#pragma once

#include "schema/blob.h"
#include "schema/error.h"

namespace cairn::datasets {

// Results say what they were made from, but the oldest.
// Throws InputError where it is another log.
inline void CheckMadeFrom(const Blob& result, const Blob& log) {
  if (!result.Has("log_hash")) return;
  const std::string made_from = result.Text("log_hash"), given = log.SourceHash().Hex();
  if (made_from != given)
    throw InputError("the result was made from another log: its content, truth and provenance aside, is " +
                     made_from + ", that of the log given here is " + given);
}

// Of two results: whether both say what they were made from, and it is not the same.
inline bool MadeFromOtherLogs(const Blob& result, const Blob& other) {
  return result.Has("log_hash") && other.Has("log_hash") && result.Text("log_hash") != other.Text("log_hash");
}

}  // namespace cairn::datasets
