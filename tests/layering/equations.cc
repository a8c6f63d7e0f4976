#include "tests/layering/equations.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <set>

#include "tests/layering/include_rules.h"

namespace cairn::layering {
namespace {

namespace fs = std::filesystem;

constexpr std::array kSharedFolders = {"pipelines/common", "datasets/evaluate"};

struct Kind {
  const char* one;
  const char* several;
};
constexpr std::array kKinds = {Kind{"eq. ", "eqs "}, Kind{"section ", "sections "},
                               Kind{"figure ", "figures "}, Kind{"table ", "tables "},
                               Kind{"footnote ", "footnotes "}};

bool IsDigit(char c) { return c >= '0' && c <= '9'; }
bool IsLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

// Reads a text from left to right.
class Reader {
 public:
  explicit Reader(const std::string& text) : text_(text) {}

  bool AtEnd() const { return at_ >= text_.size(); }
  void Skip() { ++at_; }

  bool Take(const std::string& word) {
    if (text_.compare(at_, word.size(), word) != 0) return false;
    at_ += word.size();
    return true;
  }

  // "[TBF98] ": its letters and digits.
  std::optional<std::string> TakePaper() {
    static const std::regex kPaper(R"(^\[([A-Z][A-Za-z]*[0-9]{2})\])");
    std::smatch match;
    const std::string rest = text_.substr(at_);
    if (!std::regex_search(rest, match, kPaper)) return std::nullopt;
    at_ += static_cast<std::size_t>(match.length());
    Take(" ");
    return match[1].str();
  }

  // "eq. ", "Eq. " or "eqs ", where a word begins and before a number: "eq. ".
  std::optional<std::string> TakeKind() {
    if (at_ > 0 && IsLetter(text_[at_ - 1])) return std::nullopt;
    for (const Kind& kind : kKinds) {
      for (std::string word : {kind.one, kind.several}) {
        if (TakeBeforeNumber(word)) return kind.one;
        word[0] = static_cast<char>(word[0] - 'a' + 'A');
        if (TakeBeforeNumber(word)) return kind.one;
      }
    }
    return std::nullopt;
  }

  // "5.1.6", "15, 16", "4 and 6", "19 to 21".
  std::vector<std::string> TakeNumbers() {
    std::vector<std::string> numbers{TakeNumber()};
    while (!AtEnd()) {
      if (TakeBeforeNumber(" to ")) {
        const std::string last = TakeNumber();
        for (int n = std::stoi(numbers.back()) + 1; n <= std::stoi(last); ++n)
          numbers.push_back(std::to_string(n));
      } else if (TakeBeforeNumber(", ") || TakeBeforeNumber(" and ")) {
        numbers.push_back(TakeNumber());
      } else {
        break;
      }
    }
    return numbers;
  }

  bool TakeBeforeNumber(const std::string& word) {
    const std::size_t before = at_;
    if (Take(word) && !AtEnd() && IsDigit(text_[at_])) return true;
    at_ = before;
    return false;
  }

 private:
  std::string TakeNumber() {
    const std::size_t first = at_;
    while (!AtEnd() &&
           (IsDigit(text_[at_]) || (text_[at_] == '.' && at_ + 1 < text_.size() && IsDigit(text_[at_ + 1]))))
      ++at_;
    return text_.substr(first, at_ - first);
  }

  const std::string& text_;
  std::size_t at_ = 0;
};

std::vector<std::string> LinesOf(const fs::path& file) {
  std::vector<std::string> lines;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::string Trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

bool IsComment(const std::string& line) { return line.starts_with("//"); }

// Whether the comment that ends before line `next` stands above what computes: in a header above a function's
// body.
bool IsAboveCode(const std::vector<std::string>& lines, std::size_t next, bool header) {
  while (next < lines.size() && IsComment(Trimmed(lines[next]))) ++next;
  if (next == lines.size() || Trimmed(lines[next]).empty() || lines[next].starts_with("#")) return false;
  if (!header) return true;
  if (std::regex_search(Trimmed(lines[next]), std::regex("^(struct|class|enum|namespace) "))) return false;
  for (; next < lines.size(); ++next) {
    const std::size_t end = lines[next].find_first_of("{;");
    if (end != std::string::npos) return lines[next][end] == '{';
  }
  return false;
}

struct Comment {
  std::string file;
  int line;
  Reference reference;
  bool computes;  // begins the line, above code
};

struct Row {
  int line;
  std::vector<Reference> references;
  std::string functions, tests;
};

// The cells of a row of a table; `\|` does not end one.
std::vector<std::string> CellsOf(const std::string& line) {
  std::vector<std::string> cells(1);
  for (std::size_t i = 1; i < line.size(); ++i) {
    if (line[i] == '|' && line[i - 1] != '\\')
      cells.emplace_back();
    else
      cells.back() += line[i];
  }
  for (std::string& cell : cells) cell = Trimmed(cell);
  return cells;
}

std::vector<std::string> CodeIn(const std::string& cell) {
  static const std::regex kCode("`([^`]*)`");
  std::vector<std::string> code;
  for (std::sregex_iterator match(cell.begin(), cell.end(), kCode), end; match != end; ++match)
    code.push_back((*match)[1].str());
  return code;
}

class Checker {
 public:
  explicit Checker(fs::path root) : root_(std::move(root)) {}

  EquationCheck Run() {
    ReadPapers();
    ReadTests();
    for (const char* folder : kSharedFolders) ReadSources(folder, &shared_);
    std::set<Reference> in_tables;
    std::set<std::string> pipelines;
    for (const auto& entry : fs::directory_iterator(root_ / "pipelines"))
      if (entry.is_directory() && entry.path().filename() != "common")
        pipelines.insert("pipelines/" + entry.path().filename().string());
    for (const std::string& pipeline : pipelines) in_tables.merge(CheckPipeline(pipeline));
    for (const Comment& comment : shared_.comments) CheckHasRow(comment, in_tables, "any pipeline's README");
    return check_;
  }

 private:
  struct Sources {
    std::vector<Comment> comments;
    std::set<std::string> words;  // of the code and comments
  };

  void Report(const std::string& file, int line, const std::string& why) {
    check_.mismatches.push_back({file, line, why});
  }

  void ReadPapers() {
    static const std::regex kKey(R"(^ *abbreviation: *([A-Za-z0-9]+) *$)");
    std::smatch match;
    for (const std::string& line : LinesOf(root_ / "CITATION.cff"))
      if (std::regex_match(line, match, kKey)) papers_.insert(match[1].str());
    if (papers_.empty()) Report("CITATION.cff", 1, "names no paper by an 'abbreviation'");
  }

  void ReadTests() {
    static const std::regex kTest(R"(^(?:TYPED_)?TEST(?:_[FP])?\((\w+), *(\w+))");
    std::smatch match;
    for (const char* folder : {"pipelines", "datasets", "tests"}) {
      if (!fs::exists(root_ / folder)) continue;
      for (const auto& entry : fs::recursive_directory_iterator(root_ / folder)) {
        if (!entry.path().string().ends_with("_test.cc")) continue;
        std::string text;  // a long head is broken after its opening bracket
        for (const std::string& line : LinesOf(entry.path())) {
          text = text.ends_with("(") || text.ends_with(",") ? text + Trimmed(line) : line;
          if (std::regex_search(text, match, kTest)) tests_.insert(match[1].str() + "." + match[2].str());
        }
      }
    }
  }

  void ReadSources(const std::string& folder, Sources* sources) {
    if (!fs::exists(root_ / folder)) return;
    std::set<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(root_ / folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension == ".cc" || extension == ".h")
        files.insert(entry.path().lexically_relative(root_).string());
    }
    for (const std::string& file : files) ReadSource(file, sources);
  }

  void ReadSource(const std::string& file, Sources* sources) {
    const std::vector<std::string> lines = LinesOf(root_ / file);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      AddWords(lines[i], &sources->words);
      const std::size_t at = lines[i].find("//");
      if (at == std::string::npos) continue;
      const std::string comment = lines[i].substr(at);
      const std::vector<Reference> references = ReferencesIn(comment);
      const int line = static_cast<int>(i) + 1;
      if (Equations(references) != Equations(ReferencesIn(comment, "none")) && file.starts_with("pipelines/"))
        Report(file, line, "an equation without the paper's key before it: [TBF98] eq. 16");
      const bool begins = Trimmed(lines[i]).starts_with("// [") && at == lines[i].find_first_not_of(' ');
      const bool computes = begins && !IsTest(file) && IsAboveCode(lines, i + 1, file.ends_with(".h"));
      for (const Reference& reference : references) {
        if (!papers_.contains(reference.paper))
          Report(file, line, "[" + reference.paper + "] is no paper of CITATION.cff");
        sources->comments.push_back({file, line, reference, computes});
      }
      check_.comments += computes && !references.empty() ? 1 : 0;
    }
  }

  static std::ptrdiff_t Equations(const std::vector<Reference>& references) {
    return std::ranges::count_if(references, [](const Reference& r) { return r.what.starts_with("eq. "); });
  }

  static void AddWords(const std::string& line, std::set<std::string>* words) {
    std::string word;
    for (const char c : line + " ") {
      if (IsLetter(c) || IsDigit(c) || c == '_') {
        word += c;
      } else if (!word.empty()) {
        words->insert(std::move(word));
        word.clear();
      }
    }
  }

  std::vector<Row> RowsOf(const std::string& readme) {
    static const std::regex kHead(R"(^\| \[(\w+)\] \| function \| test \| deviation \|$)");
    const std::vector<std::string> lines = LinesOf(root_ / readme);
    std::vector<Row> rows;
    std::string paper;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const int line = static_cast<int>(i) + 1;
      std::smatch match;
      if (std::regex_match(lines[i], match, kHead)) {
        paper = match[1].str();
        if (!papers_.contains(paper)) Report(readme, line, "[" + paper + "] is no paper of CITATION.cff");
        ++i;  // the line under the head
      } else if (!lines[i].starts_with("|")) {
        paper.clear();
      } else if (!paper.empty()) {
        const std::vector<std::string> cells = CellsOf(lines[i]);
        rows.push_back({line, ReferencesIn(cells[0].substr(0, cells[0].find(':')), paper), "", ""});
        if (cells.size() < 4) {
          Report(readme, line, "a row has four cells");
          continue;
        }
        rows.back().functions = cells[1];
        rows.back().tests = cells[2];
        if (rows.back().references.empty() && !cells[0].starts_with("not in the paper"))
          Report(readme, line, "a row begins with an equation, or with 'not in the paper'");
      }
    }
    check_.rows += static_cast<int>(rows.size());
    return rows;
  }

  // Returns what the pipeline's tables have.
  std::set<Reference> CheckPipeline(const std::string& pipeline) {
    Sources own;
    ReadSources(pipeline, &own);
    const std::string readme = pipeline + "/README.md";
    const std::vector<Row> rows = RowsOf(readme);
    std::set<Reference> in_table, computed;
    for (const Sources* sources : {&own, &shared_})
      for (const Comment& comment : sources->comments)
        if (comment.computes) computed.insert(comment.reference);
    for (const Row& row : rows) {
      for (const Reference& reference : row.references) {
        in_table.insert(reference);
        if (!computed.contains(reference))
          Report(readme, row.line,
                 "no line of the sources is under a comment that begins with [" + reference.paper + "] " +
                     reference.what);
      }
      CheckNames(readme, row, own);
    }
    if (rows.empty() && (fs::exists(root_ / readme) || !own.comments.empty()))
      Report(readme, 1,
             "has no table '| [KEY] | function | test | deviation |' of what the pipeline computes");
    for (const Comment& comment : own.comments) CheckHasRow(comment, in_table, readme);
    return in_table;
  }

  void CheckHasRow(const Comment& comment, const std::set<Reference>& in_table, const std::string& where) {
    // Sentences may name other sections and figures.
    if (!comment.computes && !comment.reference.what.starts_with("eq. ")) return;
    if (!in_table.contains(comment.reference))
      Report(comment.file, comment.line,
             "names [" + comment.reference.paper + "] " + comment.reference.what + ", which the table of " +
                 where + " does not have");
  }

  void CheckNames(const std::string& readme, const Row& row, const Sources& own) {
    static const std::regex kName(R"([A-Za-z_]\w*(::[A-Za-z_]\w*)*)");
    for (const std::string& name : CodeIn(row.functions)) {
      if (!std::regex_match(name, kName)) continue;  // a file or an option's value
      const std::size_t last = name.rfind(':');
      const std::string word = last == std::string::npos ? name : name.substr(last + 1);
      if (!own.words.contains(word) && !shared_.words.contains(word))
        Report(readme, row.line, "names the function " + name + ", which the sources do not have");
    }
    for (const std::string& name : CodeIn(row.tests)) {
      const std::size_t open = std::min(name.find("…"), name.find('*'));
      if (open == 0 || name.find('.') == std::string::npos) continue;
      const std::string begin = name.substr(0, open);
      const auto test = tests_.lower_bound(begin);
      const bool found =
          test != tests_.end() && (open == std::string::npos ? *test == begin : test->starts_with(begin));
      if (!found) Report(readme, row.line, "names the test " + name + ", which does not exist");
    }
  }

  fs::path root_;
  EquationCheck check_;
  std::set<std::string> papers_, tests_;
  Sources shared_;
};

}  // namespace

std::vector<Reference> ReferencesIn(const std::string& text, const std::string& paper) {
  std::vector<Reference> references;
  Reader reader(text);
  std::string now = paper;
  while (!reader.AtEnd()) {
    if (const auto named = reader.TakePaper()) now = *named;
    const auto kind = reader.TakeKind();
    if (!kind) {
      reader.Skip();
      now = paper;
      continue;
    }
    std::vector<std::string> found;
    for (const std::string& number : reader.TakeNumbers()) found.push_back(*kind + number);
    if (*kind == "figure " && (reader.TakeBeforeNumber(", step ") || reader.TakeBeforeNumber(", steps "))) {
      const std::string figure = found.back();
      found.pop_back();
      for (const std::string& step : reader.TakeNumbers()) found.push_back(figure + ", step " + step);
    }
    if (!now.empty())
      for (const std::string& what : found) references.push_back({now, what});
    if (!reader.Take(", ")) reader.Take(" and ");  // more of the same paper
  }
  return references;
}

std::string ToText(const Mismatch& mismatch) {
  return mismatch.file + ":" + std::to_string(mismatch.line) + ": " + mismatch.why;
}

EquationCheck CheckEquations(const fs::path& root) { return Checker(root).Run(); }

}  // namespace cairn::layering
