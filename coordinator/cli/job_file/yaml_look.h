// A look at a YAML text before anything is made of it. In some texts ("!,o") yaml-cpp's LoadAll finds
// documents without end; deep nests overflow its stack; a few aliases of long lists stand for more work than
// there is time.
#pragma once

#include <string>

namespace cairn::cli {

struct YamlLook {
  int documents = 0;    // that are not empty, of the first two
  int second_line = 0;  // where the second begins
  int line = 0;         // of the problem
  std::string problem;  // why it is not to be read; empty: it may be
};

// Throws YAML::Exception where it is no YAML.
YamlLook LookThroughYaml(const std::string& text);

}  // namespace cairn::cli
