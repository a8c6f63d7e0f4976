// Options whose names have changed before the first release. For one release more the old ones are
// understood, with a warning that says the new one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cairn::cli {

// What `name` is called now; itself where it has not changed. `of`: the pipeline whose option it is; "" for a
// flag of the command line, that flag for a word that it takes.
std::string NameNow(std::string_view of, const std::string& name);

// To stderr. `before` and `now` as they are written.
void WarnOfOldName(const std::string& before, const std::string& now);

// An argument of the command line, which follows `before_it`, with the names of today; warns where it had
// another.
std::string ArgumentNow(const std::string& before_it, const std::string& argument);

// The same of all of `words` up to a "--", of which the first is the program: they point into what is
// returned.
std::vector<std::string> ArgumentsNow(std::vector<char*>* words);

}  // namespace cairn::cli
