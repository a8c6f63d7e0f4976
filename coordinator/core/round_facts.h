// What the rounds of a stage cost, in rows that stay few: each checkpoint holds all of them, and a stage may
// have a million rounds.
#pragma once

#include "schema/checkpoint.pb.h"

namespace cairn::coordinator {

inline constexpr int kMostRoundFacts = 4096;    // rows of a stage
inline constexpr int kRecentRoundFacts = 1024;  // the last of them: each of one round

// Adds a row. Where there are too many, neighbours are made one: their tasks and times add up, the later
// one's note stays. The first row, of START, and the recent ones keep to themselves.
void AddRoundFacts(proto::RoundFacts row, proto::StageFacts* facts);

}  // namespace cairn::coordinator
