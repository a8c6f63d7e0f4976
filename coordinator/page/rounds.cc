#include "coordinator/page/rounds.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "coordinator/page/html.h"

namespace cairn::page {
namespace {

constexpr std::size_t kLinesKept = 2000;
constexpr std::size_t kRoundsKept = 5000;
constexpr std::size_t kMostPoints = 240;  // of a chart

struct KnownFigure {
  const char* before;  // the number, in a note
  const char* name;
  const char* unit;
};
// "held out 12.5%" is how much less the error is than without any observation.
constexpr KnownFigure kKnown[] = {
    {"log-likelihood ", "log-likelihood", "nats"},
    {"error ", "posterior error", ""},
    {"held out ", "held-out error, reduced by", "%"},
    {"reduced by ", "posterior error, reduced by", "%"},
};

// The number that begins at `at`; false where none does.
bool NumberAt(const std::string& text, std::size_t at, double* value, std::size_t* end = nullptr) {
  const char* from = text.data() + std::min(at, text.size());
  const auto [past, error] = std::from_chars(from, text.data() + text.size(), *value);
  if (end != nullptr) *end = static_cast<std::size_t>(past - text.data());
  return error == std::errc() && std::isfinite(*value);
}

// What stands at `at` must be `word`; the place behind it then.
bool Skip(const std::string& text, std::string_view word, std::size_t* at) {
  if (text.compare(*at, word.size(), word) != 0) return false;
  *at += word.size();
  return true;
}

// "0.123 m of 0.5 m": the letters behind the number are its unit.
std::string UnitAt(const std::string& text, std::size_t at) {
  if (at < text.size() && text[at] == '%') return "%";
  if (at + 1 >= text.size() || text[at] != ' ') return "";
  std::size_t end = at + 1;
  while (end < text.size() && (std::isalpha(static_cast<unsigned char>(text[end])) != 0 || text[end] == '2'))
    ++end;
  const std::string word = text.substr(at + 1, end - at - 1);
  return word == "of" ? "" : word;
}

struct Point {
  double x, y;
};

struct Chart {
  std::string title, unit;
  std::vector<Point> points;
};

// Every so many, and the last.
std::vector<Point> Thinned(const std::vector<Point>& points) {
  const std::size_t step = points.size() / kMostPoints + 1;
  std::vector<Point> kept;
  for (std::size_t i = 0; i < points.size(); i += step) kept.push_back(points[i]);
  if (!kept.empty() && kept.back().x != points.back().x) kept.push_back(points.back());
  return kept;
}

// Round numbers between: at most `count` of them.
std::vector<double> Ticks(double low, double high, int count) {
  const double raw = (high - low) / count, power = std::pow(10, std::floor(std::log10(raw)));
  double step = 10 * power;
  for (const double times : {1.0, 2.0, 5.0})
    if (times * power >= raw) {
      step = times * power;
      break;
    }
  std::vector<double> ticks;
  for (double at = std::ceil(low / step) * step; at <= high + 1e-9 * step; at += step)
    ticks.push_back(std::abs(at) < 1e-9 * step ? 0 : at);
  return ticks;
}

// "0.5", not "0.5000".
std::string TickText(double value) {
  std::string text = Number(value);
  if (text.find('.') == std::string::npos || text.find('e') != std::string::npos) return text;
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

constexpr double kWidth = 480, kHeight = 190, kLeft = 64, kRight = 12, kTop = 10, kBottom = 36;

class Frame {
 public:
  explicit Frame(const std::vector<Point>& points) {
    x0_ = points.front().x;
    x1_ = std::max(points.back().x, x0_ + 1);
    y0_ = y1_ = points.front().y;
    for (const Point& point : points) {
      y0_ = std::min(y0_, point.y);
      y1_ = std::max(y1_, point.y);
    }
    const double least = std::max(1e-9, 1e-6 * std::max(std::abs(y0_), std::abs(y1_)));
    const double margin = std::max(least, 0.06 * (y1_ - y0_));
    y0_ -= margin;
    y1_ += margin;
  }
  double X(double x) const { return kLeft + (x - x0_) / (x1_ - x0_) * (kWidth - kLeft - kRight); }
  double Y(double y) const {
    return kHeight - kBottom - (y - y0_) / (y1_ - y0_) * (kHeight - kTop - kBottom);
  }

  std::string Axes(const std::string& unit) const {
    std::string svg;
    for (const double y : Ticks(y0_, y1_, 4))
      svg += fmt::format(
          "<path class=\"grid\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>"
          "<text class=\"tick end\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>",
          kLeft, Y(y), kWidth - kRight, kLeft - 6, Y(y) + 4, TickText(y));
    for (const double x : Ticks(x0_, x1_, 6))
      if (x == std::floor(x))
        svg += fmt::format("<text class=\"tick middle\" x=\"{:.1f}\" y=\"{:.1f}\">{:.0f}</text>", X(x),
                           kHeight - kBottom + 16, x);
    svg += fmt::format("<text class=\"tick end\" x=\"{:.1f}\" y=\"{:.1f}\">round</text>", kWidth - kRight,
                       kHeight - 4);
    if (!unit.empty())
      svg += fmt::format("<text class=\"tick\" x=\"2\" y=\"{:.1f}\">{}</text>", kHeight - 4, Text(unit));
    return svg;
  }

 private:
  double x0_, x1_, y0_, y1_;
};

std::string ChartHtml(const Chart& chart) {
  const std::vector<Point> points = Thinned(chart.points);
  const Frame frame(points);
  std::string line, values;
  for (const Point& point : points) {
    values += fmt::format("{}{},{}", values.empty() ? "" : " ", point.x, TickText(point.y));
    line += fmt::format("{}{:.1f} {:.1f}", line.empty() ? "M" : "L", frame.X(point.x), frame.Y(point.y));
  }
  const Point& last = points.back();
  const std::string unit = chart.unit.empty() ? "" : (chart.unit == "%" ? "" : " ") + chart.unit;
  const std::string value = TickText(last.y) + unit;
  return fmt::format(
      "<figure class=\"chart\"><figcaption><span>{0}</span> <b>{1}</b></figcaption>"
      "<svg viewBox=\"0 0 {2} {3}\" role=\"img\" aria-label=\"{0}: {1} after round {4:.0f}\" "
      "data-from=\"{9}\" data-to=\"{10}\" data-unit=\"{11}\" data-values=\"{12}\">{5}"
      "<path class=\"curve\" d=\"{6}\"/><circle class=\"dot\" cx=\"{7:.1f}\" cy=\"{8:.1f}\" r=\"4\"/>"
      "</svg>{13}</figure>\n",
      Text(chart.title), Text(value), kWidth, kHeight, last.x, frame.Axes(chart.unit), line, frame.X(last.x),
      frame.Y(last.y), kLeft, kWidth - kRight, Text(unit), values, SaveButton("SVG", "this curve"));
}

// In the order in which their first rounds came; the time that rounds take comes last.
std::vector<Chart> ChartsOf(const std::vector<RoundLine>& rounds) {
  std::vector<Chart> charts;
  const auto add = [&charts](const std::string& title, const std::string& unit, Point point) {
    auto chart = std::ranges::find(charts, title, &Chart::title);
    if (chart == charts.end()) chart = charts.insert(charts.end(), {title, unit, {}});
    chart->points.push_back(point);
  };
  std::map<std::string, bool> stages;
  for (const RoundLine& round : rounds) stages[round.stage] = true;
  const auto named = [&](const RoundLine& round, const std::string& what) {
    return stages.size() > 1 ? round.stage + ": " + what : what;
  };
  for (const RoundLine& round : rounds)
    for (const Figure& figure : round.figures)
      add(named(round, figure.name), figure.unit, {static_cast<double>(round.number), figure.value});
  for (const RoundLine& round : rounds)
    add(named(round, "time a round took"), "s", {static_cast<double>(round.number), round.seconds});
  return charts;
}

}  // namespace

std::vector<Figure> FiguresIn(const std::string& note) {
  std::vector<Figure> figures;
  for (const KnownFigure& known : kKnown) {
    const std::string before = known.before;
    for (std::size_t at = note.find(before); at != std::string::npos; at = note.find(before, at + 1)) {
      double value = 0;
      std::size_t end = 0;
      const bool is_word = at == 0 || note[at - 1] == ' ';
      if (!is_word || !NumberAt(note, at + before.size(), &value, &end)) continue;
      figures.push_back({known.name, *known.unit != '\0' ? known.unit : UnitAt(note, end), value});
      break;
    }
  }
  return figures;
}

bool ReadRoundLine(const std::string& text, RoundLine* round) {
  const std::string begin = "stage '", middle = "', round ";
  const std::size_t quote = text.find(middle);
  if (!text.starts_with(begin) || quote == std::string::npos) return false;
  RoundLine line;
  line.stage = text.substr(begin.size(), quote - begin.size());
  double number = 0, tasks = 0;
  std::size_t at = quote + middle.size();
  if (!NumberAt(text, at, &number, &at) || !Skip(text, ": ", &at) || !NumberAt(text, at, &tasks, &at) ||
      !(Skip(text, " tasks in ", &at) || Skip(text, " task in ", &at)) ||
      !NumberAt(text, at, &line.seconds, &at) || !Skip(text, " s, ", &at) ||
      !NumberAt(text, at, &line.work_s, &at) || !Skip(text, " s of work", &at) || number < 0 || tasks < 0 ||
      number > 1e15 || tasks > 4e9)
    return false;
  if (Skip(text, ": ", &at)) line.note = text.substr(at);
  line.number = static_cast<std::uint64_t>(number);
  line.tasks = static_cast<std::uint32_t>(tasks);
  line.figures = FiguresIn(line.note);
  *round = std::move(line);
  return true;
}

void JobHistory::Add(const std::vector<wire::LogLine>& lines) {
  for (const wire::LogLine& line : lines) {
    if (line.number() <= last()) continue;
    lines_.push_back(line);
    if (RoundLine round; ReadRoundLine(line.text(), &round)) rounds_.push_back(std::move(round));
  }
  const auto cut = [](auto& list, std::size_t most) {
    if (list.size() > most) list.erase(list.begin(), list.end() - static_cast<std::ptrdiff_t>(most));
  };
  cut(lines_, kLinesKept);
  cut(rounds_, kRoundsKept);
}

std::string ChartsHtml(const std::vector<RoundLine>& rounds) {
  std::string html;
  for (const Chart& chart : ChartsOf(rounds))
    if (chart.points.size() > 1) html += ChartHtml(chart);
  return html.empty() ? "" : "<div class=\"charts\">\n" + html + "</div>\n";
}

std::string RoundsCsv(const std::vector<RoundLine>& rounds) {
  std::string csv = "stage,round,tasks,figure,value,unit\n";
  for (const RoundLine& round : rounds) {
    std::string stage = round.stage;  // of letters, digits and what a job file's names may have
    std::ranges::replace_if(stage, [](char c) { return c == ',' || c == '"' || c == '\n'; }, '_');
    const auto add = [&](const std::string& name, double value, const std::string& unit) {
      csv += fmt::format("{},{},{},{},{},{}\n", stage, round.number, round.tasks, name, value, unit);
    };
    add("time a round took", round.seconds, "s");
    add("work", round.work_s, "s");
    for (const Figure& figure : round.figures) add(figure.name, figure.value, figure.unit);
  }
  return csv;
}

}  // namespace cairn::page
