#include "coordinator/scale/engines/hosts_file.h"

#include <algorithm>
#include <cctype>
#include <sstream>

#include "schema/error.h"
#include "schema/text.h"

namespace cairn::coordinator {
namespace {

constexpr int kMostCores = 10'000;

// Nothing that ssh would take for an option.
bool IsHostName(const std::string& name) {
  return std::isalnum(static_cast<unsigned char>(name[0])) != 0 &&
         std::ranges::all_of(name, [](unsigned char c) {
           return std::isalnum(c) != 0 ||
                  std::string_view("._-@:[]").find(static_cast<char>(c)) != std::string_view::npos;
         });
}

}  // namespace

std::vector<Host> ParseHosts(const std::string& text, const std::string& file) {
  std::vector<Host> hosts;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const auto fail = [&](const std::string& why) {
      throw InputError(file + ", line " + std::to_string(number) + ": " + why);
    };
    std::istringstream words(line.substr(0, line.find('#')));
    Host host;
    if (!(words >> host.name)) continue;
    if (!IsHostName(host.name)) fail("'" + Printable(host.name, 100) + "' is no host");
    if (!(words >> host.cores) || host.cores < 1 || host.cores > kMostCores)
      fail("after the host comes how many cores, 1 to " + std::to_string(kMostCores) +
           ": HOST CORES [MEMORY_MB]");
    if (std::string word; words >> word) {
      std::istringstream memory(word);
      if (!(memory >> host.memory_mb) || !memory.eof() || word.starts_with('-'))
        fail("'" + Printable(word, 100) + "' is no memory in MB");
      if (words >> word) fail("'" + Printable(word, 100) + "' is one word too many: HOST CORES [MEMORY_MB]");
    }
    if (std::ranges::find(hosts, host.name, &Host::name) != hosts.end())
      fail("'" + host.name + "' is here twice");
    hosts.push_back(host);
  }
  if (hosts.empty()) throw InputError(file + ": names no host");
  return hosts;
}

}  // namespace cairn::coordinator
