// What a command says goes out through here: names of robots, datasets, jobs and files are strangers' texts,
// and a terminal obeys what it is sent.
#pragma once

#include <cstdio>

namespace cairn::cli {

// From here on whatever this process writes to `stdout` and `stderr`, by whatever function, goes out as
// Escaped() (schema/text.h) has it. Called once, by main.
void EscapeOutput();

// Sends what is left of a character that was cut short. False where anything could not be written.
bool FinishOutput();

// The standard error as it is, for what draws on a terminal. The caller escapes.
std::FILE* Terminal();

}  // namespace cairn::cli
