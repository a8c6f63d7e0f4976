// The pictures and the page that a command leaves beside results, which nobody has asked for by name: a file
// of the user's own that is called the same must not be lost to them.
#pragma once

#include <string>
#include <vector>

namespace cairn::cli {

// Throws InputError where one of them (map.png, picture.png, report.html of `dir` and of its folders named as
// `stages`) is there and is not the very file that RememberPages saw.
void CheckPagesAreOurs(const std::string& dir, const std::vector<std::string>& stages);

// They were written just now: DIR/.cairn-pages keeps their hashes.
void RememberPages(const std::string& dir, const std::vector<std::string>& stages);

// The same of one page, in a folder whose pages are remembered.
void RememberPage(const std::string& path);

// Throws InputError, unless `force`, of the folder of a study, which is filled with files of many names: one
// that holds something, but no `results` of an earlier study.
void CheckFolderIsFree(const std::string& folder, bool force);

}  // namespace cairn::cli
