// The kinds of Cairn's files (schema/FORMAT.md), a row each.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "schema/blob.h"
#include "schema/kinds/array_spec.h"

namespace cairn {

struct Kind {
  std::string_view name;
  // An array that each file of the kind has, and no file of a kind above it in the table.
  std::string_view mark;
  bool is_plural = false;  // as a word
  bool is_given = false;   // people make it, and may change it; else a pipeline does: it is a result
  bool has_units = false;  // times, distances and angles as somebody wrote them: their units may be wrong
  std::span<const ArraySpec> (*arrays)() = nullptr;  // that its section of schema/FORMAT.md lists
};

std::span<const Kind> Kinds();

std::span<const ArraySpec> ProvenanceArrays();  // in a file of any kind

// Null where there is none of that name: of a file of a newer Cairn, or of a pipeline that has a kind of its
// own.
const Kind* FindKind(std::string_view name);

// The kind that a blob is of, by the arrays that it has; "result" where it is of none. The blob itself says
// it, so that a coordinator, which knows no pipeline, and a client, which fetches results, store the same.
std::string KindOf(const Blob& blob);

// Checks what is there of the kind's arrays, and of the provenance: their types, that their shapes fit each
// other, and that they hold what they may. Of a kind that is not known, the provenance alone. Whoever reads a
// file of somebody else's calls it once; after it arrays of one length are of one length, and indices lie
// within what they name.
// Throws InputError that names the array, the entry and what is allowed.
void CheckKind(const Blob& blob, std::string_view kind);

// Checks what a stage is given as its input `role`, as what it is and as what is read of it: a local_map may
// stand for poses. A pipeline may rely on it. Of an array without its elements its form is checked. Throws
// InputError that names the input too.
void CheckInput(const Blob& blob, const std::string& role);

// "a log", "samples"; "a log is needed", "samples are needed".
std::string WithArticle(std::string_view kind);
std::string IsNeeded(std::string_view kind);

}  // namespace cairn
