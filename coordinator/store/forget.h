// What goes with a job that is deleted where its results lie behind a link. Whoever hands on a store may have
// put that there: nothing goes for its name's sake.
#pragma once

#include <filesystem>
#include <string>

namespace cairn::coordinator {

// Removes from `results` what was published of `job`, whose checkpoints are in the folder `checkpoints`, and
// then the folder, where nothing else is in it. What cannot be read stays.
void RemovePublished(const std::filesystem::path& results, const std::string& job,
                     const std::filesystem::path& checkpoints);

}  // namespace cairn::coordinator
