#include "coordinator/page/start_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "coordinator/page/html.h"
#include "schema/text.h"

namespace cairn::page {
namespace {

using Json = nlohmann::json;

// What others wrote is of any type.
std::string TextIn(const Json& json, const char* name) {
  if (!json.is_object()) return "";
  const auto value = json.find(name);
  if (value == json.end() || value->is_null()) return "";
  return value->is_string() ? value->get<std::string>() : value->dump();
}

std::string TroubleHtml(const std::string& text) {
  return text.empty() ? "" : "<div class=\"advice bad\"><p>" + Text(text) + "</p></div>\n";
}

std::string Hidden(const std::string& token) {
  return "<input type=\"hidden\" name=\"token\" value=\"" + Text(token) + "\">";
}

// "1.5 GB, log"
std::string WhatItIs(const BroughtFile& file) {
  const std::string kind = file.Kind();
  return BytesText(file.bytes) + (file.looked_at ? kind.empty() ? ", no file of Cairn's" : ", " + kind : "");
}

std::string FileRow(const BroughtFile& file, const std::string& token) {
  const std::string address = AddressOf(file);
  return "<tr><th scope=\"row\"><a href=\"" + address + "\">" + Text(file.name) +
         "</a></th><td data-label=\"What it is\">" + Text(WhatItIs(file)) +
         "</td><td><form method=\"post\" action=\"" + address + "/remove\">" + Hidden(token) +
         "<button>Remove</button></form></td></tr>\n";
}

std::string FactList(const Json& facts) {
  std::string html;
  for (const auto& [name, value] : facts.items())
    html += "<div><dt>" + Text(name) + "</dt><dd>" +
            Text(value.is_string() ? value.get<std::string>() : value.dump()) + "</dd></div>\n";
  return html.empty() ? "" : "<dl class=\"facts told\">\n" + html + "</dl>\n";
}

std::string Doubts(const Json& content) {
  std::string items;
  for (const char* list : {"unit_doubts", "warnings"})
    for (const Json& doubt : ListIn(content, list))
      if (doubt.is_string()) items += "<li>" + Text(doubt.get<std::string>()) + "</li>\n";
  if (const std::string wrong = TextIn(content, "wrong"); !wrong.empty())
    items += "<li>" + Text(wrong) + "</li>\n";
  return items.empty() ? "" : "<h2>In doubt</h2>\n<ul class=\"failures\">\n" + items + "</ul>\n";
}

std::string ArrayCell(const char* label, const std::string& text, const char* kind = "") {
  return fmt::format("<td data-label=\"{}\" class=\"{}\">{}</td>", label, kind, Text(text));
}

std::string ArraysHtml(const Json& arrays) {
  constexpr std::size_t kMostShown = 500;
  std::string rows;
  std::size_t shown = 0;
  for (const Json& array : arrays) {
    if (++shown > kMostShown) break;
    std::string values = TextIn(array, "sample");
    const auto low = array.find("low"), high = array.find("high");
    if (low != array.end() && high != array.end() && low->is_number() && high->is_number() &&
        TextIn(array, "shape") != "[]")
      values = Number(low->get<double>()) + " to " + Number(high->get<double>());
    const std::string unit = TextIn(array, "unit"), shape = TextIn(array, "shape");
    rows += "<tr><th scope=\"row\">" + Text(TextIn(array, "name")) + "</th>" +
            ArrayCell("Shape", shape == "[]" ? "" : shape, "number") +
            ArrayCell("Type", TextIn(array, "type")) + ArrayCell("Unit", unit == "1" ? "" : unit) +
            ArrayCell("Values", CutTo(values, 120), "said") + "</tr>\n";
  }
  if (rows.empty()) return "";
  return fmt::format(
             "<details><summary>{}{}</summary>\n<table class=\"cards\"><thead><tr><th>Array</th><th "
             "class=\"number\">Shape</th><th>Type</th><th>Unit</th><th>Values</th></tr></thead>\n<tbody>\n",
             Count(arrays.size(), "array"),
             arrays.size() > kMostShown ? fmt::format(", of which the first {} are here", kMostShown) : "") +
         rows + "</tbody></table></details>\n";
}

// Two inputs have the name of the kind of file that they need; of others the pipeline knows.
bool Reads(const std::string& input, const std::string& kind) {
  const auto is_given = [](const std::string& name) { return name == "log" || name == "samples"; };
  return is_given(input) || is_given(kind) ? input == kind : true;
}

// "0.5", "1500", "29.7 million"
std::string Short(double value) {
  return std::abs(value) < 1e6 ? fmt::format("{:.4g}", value) : fmt::format("{:.4g} million", value / 1e6);
}

std::string FirstInput(const Json& pipeline) {
  const Json& inputs = ListIn(pipeline, "inputs");
  return inputs.empty() ? "" : TextIn(inputs.front(), "name");
}

std::string Choice(const std::string& value, const std::string& chosen, const std::string& words) {
  return "<option value=\"" + Text(value) + "\"" + (value == chosen ? " selected" : "") + ">" + Text(words) +
         "</option>";
}

// "0.01 to 10 m"
std::string RangeOf(const Json& option, const std::string& unit) {
  const auto bound = [&](const char* name) {
    const auto value = option.find(name);
    return value != option.end() && value->is_number() ? Short(value->get<double>()) : std::string();
  };
  const std::string low = bound("low"), high = bound("high"), type = TextIn(option, "type");
  if (low.empty() || high.empty()) return "";
  return (type == "integer" ? "whole, " : "") + low + " to " + high + (unit.empty() ? "" : " " + unit);
}

std::string BoundOf(const Json& option, const char* name, const char* attribute) {
  const auto value = option.find(name);
  if (value == option.end() || !value->is_number() || !std::isfinite(value->get<double>())) return "";
  return fmt::format(" {}=\"{}\"", attribute, value->get<double>());
}

// What is empty is the default.
std::string FieldOf(const Json& option, const std::string& given) {
  const std::string name = TextIn(option, "name"), type = TextIn(option, "type"),
                    standard = TextIn(option, "default");
  const std::string begin = "name=\"set." + Text(name) + "\" id=\"set." + Text(name) +
                            "\" aria-describedby=\"about." + Text(name) + "\"";
  std::vector<std::string> choices;
  for (const Json& choice : ListIn(option, "choices"))
    if (choice.is_string()) choices.push_back(choice.get<std::string>());
  if (type == "boolean") choices = {"true", "false"};
  if (!choices.empty()) {
    std::string all = Choice("", given, "default: " + standard);
    for (const std::string& choice : choices) all += Choice(choice, given, choice);
    return "<select " + begin + ">" + all + "</select>";
  }
  const bool number = type == "real" || type == "integer";
  return "<input " + begin + " autocomplete=\"off\" maxlength=\"4000\" value=\"" + Text(given) +
         "\" placeholder=\"" + Text(standard.empty() ? "none" : standard) + "\"" +
         (number ? std::string(" type=\"number\" step=\"") + (type == "integer" ? "1" : "any") + "\"" +
                       BoundOf(option, "low", "min") + BoundOf(option, "high", "max")
                 : " type=\"text\"") +
         ">";
}

std::string OptionHtml(const Json& option, const JobOrder& order) {
  const std::string name = TextIn(option, "name"), unit = TextIn(option, "unit");
  const auto given = order.settings.find(name);
  const std::string range = RangeOf(option, unit), standard = TextIn(option, "default");
  std::string about = standard.empty() ? "" : "default " + standard + (unit.empty() ? "" : " " + unit);
  if (!range.empty()) about += (about.empty() ? "" : "; ") + range;
  return "<div class=\"option\"><label for=\"set." + Text(name) + "\">" + Text(name) +
         (unit.empty() ? "" : " <span>" + Text(unit) + "</span>") + "</label>" +
         FieldOf(option, given == order.settings.end() ? "" : given->second) + "<small id=\"about." +
         Text(name) + "\"><b>" + Text(about) + "</b> " + Text(TextIn(option, "help")) + "</small></div>\n";
}

std::string InputsHtml(const StartContext& context, const BroughtFile& file, const Json& pipeline,
                       const JobOrder& order) {
  std::string html;
  for (const Json& input : ListIn(pipeline, "inputs")) {
    const std::string name = TextIn(input, "name");
    if (&input == &ListIn(pipeline, "inputs").front()) {
      html += "<div class=\"option\"><label>" + Text(name) + "</label><output>" + Text(file.name) +
              "</output></div>\n";
      continue;
    }
    const bool optional = input.value("optional", false);
    const auto given = order.inputs.find(name);
    const std::string chosen = given == order.inputs.end() ? "" : std::to_string(given->second);
    std::string files = Choice("", chosen, optional ? "none" : "choose a file");
    for (const BroughtFile& other : context.files)
      if (other.number != file.number && other.trouble.empty())
        files += Choice(std::to_string(other.number), chosen, other.name + " (" + WhatItIs(other) + ")");
    html += "<div class=\"option\"><label for=\"input." + Text(name) + "\">" + Text(name) +
            "</label><select id=\"input." + Text(name) + "\" name=\"input." + Text(name) + "\"" +
            (optional ? "" : " required") + ">" + files + "</select><small>" +
            (optional ? "may be left out" : "bring it first, where it is not on the list") +
            "</small></div>\n";
  }
  return html;
}

std::string JobFields(const JobOrder& order) {
  std::string priorities;
  for (int priority = 10; priority >= -10; --priority) {
    const std::string text = std::to_string(priority);
    priorities += Choice(text, order.priority.empty() ? "0" : order.priority, text);
  }
  return "<div class=\"option\"><label for=\"name\">Name of the job</label><input id=\"name\" name=\"name\" "
         "maxlength=\"200\" autocomplete=\"off\" value=\"" +
         Text(order.name) + "\" placeholder=\"" + Text(order.pipeline) +
         "\"></div>\n<div class=\"option\"><label for=\"seed\">Seed</label><input id=\"seed\" name=\"seed\" "
         "type=\"number\" min=\"0\" step=\"1\" placeholder=\"0\" value=\"" +
         Text(order.seed) +
         "\"></div>\n<div class=\"option\"><label for=\"priority\">Priority</label><select id=\"priority\" "
         "name=\"priority\">" +
         priorities + "</select><small>each step doubles its share of the workers</small></div>\n";
}

// The coordinator has what a job was given until that is done or cancelled, its results for longer.
std::string FromJobForm(const StartContext& context) {
  return "<h2>From another job</h2>\n<form class=\"filter\" method=\"post\" action=\"/new/from-job\">\n" +
         Hidden(context.token) +
         "<label>Job <input name=\"job\" required maxlength=\"300\" autocomplete=\"off\" placeholder=\"its "
         "id\" value=\"" +
         Text(context.job) +
         "\"></label>\n<label>Take <select name=\"what\"><option value=\"inputs\">what it was made of, until "
         "it "
         "is done</option><option value=\"results\">its results</option></select></label>\n<button>Bring "
         "them "
         "here</button>\n</form>\n";
}

}  // namespace

const Json& ListIn(const Json& json, const char* name) {
  static const Json kNone = Json::array();
  const auto value = json.is_object() ? json.find(name) : json.end();
  return json.is_object() && value != json.end() && value->is_structured() ? *value : kNone;
}

std::string AddressOf(const BroughtFile& file) { return "/new/" + std::to_string(file.number); }

std::string FilesHtml(const StartContext& context, const std::string& trouble) {
  std::string rows;
  for (const BroughtFile& file : context.files) rows = FileRow(file, context.token) + rows;
  if (!rows.empty())
    rows =
        "<h2>Files that are here</h2>\n<p>They go when “cairn page” ends; a job has its own copy once it is "
        "submitted.</p>\n<table class=\"cards\"><thead><tr><th>File</th><th>What it "
        "is</th><th></th></tr></thead>\n<tbody>\n" +
        rows + "</tbody></table>\n";
  return "<h1>Start a job</h1>\n" + TroubleHtml(trouble) +
         "<form id=\"bring\" class=\"bring\" method=\"post\" enctype=\"multipart/form-data\" "
         "action=\"/new/upload?token=" +
         UrlPart(context.token) + "\" data-most=\"" + std::to_string(context.most_bytes) +
         "\">\n<label>A log, or another file of Cairn’s <input type=\"file\" name=\"file\" "
         "required></label>\n<button>Bring it here</button>\n<progress class=\"scripted\" max=\"1\" "
         "value=\"0\" "
         "aria-label=\"uploaded\" hidden></progress>\n</form>\n<p>Files may take " +
         Text(BytesText(context.most_bytes)) + " here in all. “cairn submit” takes larger ones.</p>\n" +
         FromJobForm(context) + rows;
}

std::string FileHtml(const StartContext& context, const BroughtFile& file, const Json& pipelines) {
  std::string html = "<p class=\"crumbs\"><a href=\"/new\">Start a job</a></p>\n<h1>" + Text(file.name) +
                     "</h1>\n<p class=\"id\">" + Text(WhatItIs(file)) + "</p>\n" + TroubleHtml(file.trouble);
  html += FactList(ListIn(file.content, "facts")) + Doubts(file.content);
  std::string fit;
  if (file.trouble.empty())
    for (const Json& pipeline : pipelines)
      if (Reads(FirstInput(pipeline), file.Kind()))
        fit += "<li><a class=\"button\" href=\"" + AddressOf(file) + "/" + UrlPart(TextIn(pipeline, "name")) +
               "\">" + Text(TextIn(pipeline, "name")) + "</a> <span>" + Text(TextIn(pipeline, "summary")) +
               "</span></li>\n";
  if (!fit.empty()) html += "<h2>What to make of it</h2>\n<ul class=\"choices\">\n" + fit + "</ul>\n";
  return html + "<h2>What is in it</h2>\n" +
         (ListIn(file.content, "datasets").empty()
              ? "<p class=\"empty\">Nothing that Cairn reads as it is.</p>\n"
              : ArraysHtml(ListIn(file.content, "datasets"))) +
         "<form method=\"post\" action=\"" + AddressOf(file) + "/remove\">" + Hidden(context.token) +
         "<button>Remove it from here</button></form>\n";
}

std::string OrderHtml(const StartContext& context, const BroughtFile& file, const Json& pipeline,
                      const JobOrder& order, const std::string& said) {
  const std::string name = TextIn(pipeline, "name");
  std::string options;
  for (const Json& option : ListIn(pipeline, "options")) options += OptionHtml(option, order);
  const bool doubts = !ListIn(file.content, "unit_doubts").empty();
  return "<p class=\"crumbs\"><a href=\"/new\">Start a job</a> · <a href=\"" + AddressOf(file) + "\">" +
         Text(file.name) + "</a></p>\n<h1>" + Text(name) + "</h1>\n<p>" + Text(TextIn(pipeline, "summary")) +
         "</p>\n" + said + "<form class=\"order\" method=\"post\" action=\"" + AddressOf(file) + "/" +
         UrlPart(name) + "\">\n" + Hidden(context.token) + "<div class=\"options\">\n" +
         InputsHtml(context, file, pipeline, order) + JobFields(order) + "</div>\n" +
         (doubts ? std::string("<p><label><input type=\"checkbox\" name=\"units_are_right\" value=\"1\"") +
                       (order.units_are_right ? " checked" : "") +
                       "> The units of the log are right, whatever is in doubt</label></p>\n"
                 : "") +
         "<h2>Options</h2>\n<p>What is left empty is its default.</p>\n<div class=\"options\">\n" + options +
         "</div>\n<p class=\"links sticky\"><button name=\"do\" value=\"plan\">Estimate</button>\n<button "
         "class=\"main\" name=\"do\" value=\"submit\">Submit</button></p>\n</form>\n";
}

std::string PlanHtml(const Json& plan) {
  struct Known {
    const char *name, *words, *unit;
  };
  static constexpr std::array kKnown = {
      Known{"seconds", "Work, of one core", ""},           Known{"memory_mb", "Memory of a worker", " MB"},
      Known{"task_mb", "of that its largest task", " MB"}, Known{"store_mb", "Room in the store", " MB"},
      Known{"tasks", "Tasks of the first round", ""},      Known{"rounds", "Rounds, about", ""},
      Known{"cells", "Cells of the first round", ""}};
  std::string facts;
  const Json& expected = ListIn(plan, "expected");
  const auto add = [&facts](const std::string& what, const std::string& value) {
    facts += "<div><dt>" + Text(what) + "</dt><dd>" + Text(value) + "</dd></div>\n";
  };
  for (const Known& known : kKnown)
    if (const auto value = expected.find(known.name); value != expected.end() && value->is_number())
      add(known.words, std::string(known.name) == "seconds" ? Duration(value->get<double>()) + " min:s"
                                                            : Short(value->get<double>()) + known.unit);
  for (const auto& [name, value] : expected.items())
    if (value.is_number() && std::ranges::find(kKnown, name, &Known::name) == kKnown.end())
      add(name, Short(value.get<double>()));
  for (const auto& [name, input] : ListIn(plan, "inputs").items()) add(name, TextIn(input, "what"));
  return "<div class=\"advice\" id=\"plan\"><p><b>" + Text(TextIn(plan, "note")) + "</b></p>\n" +
         (facts.empty() ? "" : "<dl class=\"facts\">\n" + facts + "</dl>\n") + "</div>\n";
}

}  // namespace cairn::page
