// Which folder may include what: the table of docs/architecture.md, held against every #include line.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cairn::layering {

// What the sources of `folder` (and of the folders below it without a rule of their own) may include. An
// entry that ends in '/' stands for all below it, one that ends in "/*" for the files right in it. A test may
// include whatever any folder of its top folder may: schema, pipelines, datasets, worker, coordinator or
// coordinator/cli.
struct Rule {
  std::string folder;
  std::vector<std::string> allowed;
  // No files, sockets, clocks, threads: not the standard library's headers for them either.
  bool pure = false;
};

const std::vector<Rule>& Rules();

struct Finding {
  std::string file;
  int line = 0;
  std::string include;
  std::string why;
};

// "pipelines/a.cc:3: may not include …", for people.
std::string ToText(const Finding& finding);

// The .h and .cc files below `root`'s folders that have a rule, in order.
std::vector<std::string> SourcesBelow(const std::filesystem::path& root);

// Tests, and what only tests include: testing.h, testing_grid.h, all of a folder testing/.
bool IsTest(const std::string& file);

// Reads every .h and .cc below `root`'s folders that have a rule. `files_read` counts them.
std::vector<Finding> FindWrongIncludes(const std::filesystem::path& root, int* files_read);

}  // namespace cairn::layering
