// How far a result can be trusted, and why: what its page, the summary of a run and `--json` say first. Of
// each kind of result there is a file of its own beside this one.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace cairn::datasets {

// kNone: it is not known.
enum class Confidence { kNone, kLow, kFair, kHigh };

const char* Word(Confidence confidence);  // "not known", "low", "fair", "high"

// kLow over `much`, kFair over `some`.
Confidence AtMost(double value, double some, double much);

struct Verdict {
  // What lowers the trust in a result, and the words for it.
  struct Doubt {
    Confidence at_most = Confidence::kFair;
    std::string text = {};  // empty: there is none
  };

  Confidence trust = Confidence::kNone;
  std::string why;                                           // "513 loops closed, none contradicted"
  std::vector<std::pair<std::string, double>> numbers = {};  // what it rests on, with units in the names

  void AddCount(const std::string& name, std::size_t count);
  // The words once, however often the same is doubted. What is not known becomes low by a doubt that says so.
  void Add(const Doubt& doubt);
  std::string Text() const;  // "high: 513 loops closed, none contradicted"
};

}  // namespace cairn::datasets
