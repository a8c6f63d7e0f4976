// The pictures and the page that a command leaves beside results, which nobody has asked for by name: a file
// of the user's own that is called the same must not be lost to them.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace cairn::cli {

// A picture or a page.
struct Page {
  std::string name;  // within its folder: "map.png", "STAGE/map.png"
  std::string bytes;
};

// Throws InputError where one of them (map.png, picture.png, report.html of `dir` and of its folders named as
// `stages`) is there and is not what WritePagesOf wrote, or wrote for another job than `job`. None: a run,
// for which pages in a folder that holds a run are its own, whatever job they are of.
void CheckPagesAreOurs(const std::string& dir, const std::vector<std::string>& stages,
                       const std::optional<std::string>& job);

// DIR/.cairn-pages keeps the hashes of the pages, and their job. It says what is about to be there before it
// is: whenever this is killed, CheckPagesAreOurs takes what lies there.
void WritePagesOf(const std::string& dir, const std::string& job, const std::vector<Page>& pages);

// One page, whose hash is kept in the same way where it comes to lie in such a folder.
void WritePage(const std::string& path, const std::string& bytes);

// Makes the folder of a study, which is filled with files of many names, and marks it (.cairn-study). Throws
// InputError, unless `force`, of one that holds something and has no mark.
void TakeStudyFolder(const std::string& folder, bool force);

}  // namespace cairn::cli
