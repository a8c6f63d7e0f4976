#include "coordinator/cli/common/result_file.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>

#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/suggest.h"
#include "schema/kinds/kind.h"
#include "schema/store/regular_file.h"

namespace cairn::cli {

namespace fs = std::filesystem;

std::vector<std::string> FilesOf(const std::string& folder) {
  if (!fs::is_directory(folder)) {
    if (fs::exists(folder)) Check(RegularFile::Open(folder).status());  // says what it is
    throw InputError("there is no file or folder '" + folder + "'");
  }
  std::vector<std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.path().extension() == ".h5") files.push_back(entry.path().string());
  }
  std::ranges::sort(files);
  return files;
}

std::string ResultPath(const std::string& path, const std::string& kind) {
  if (fs::is_regular_file(path)) return path;
  std::vector<std::string> results;
  for (const std::string& file : FilesOf(path)) {
    if (Take(ListBlobFile(file)).kind == kind) results.push_back(file);
  }
  if (results.empty()) throw InputError("there is no " + kind + " in '" + path + "'");
  if (results.size() > 1) throw InputError("which one of '" + path + "'? " + Join(results));
  return results[0];
}

void AddChangedFlag(Command command, bool* changed_too) {
  command.AddFlag("--changed", *changed_too,
                  "Take a result although another program has changed it since Cairn wrote it");
}

void WarnOfChanged(const std::string& path) {
  std::fprintf(stderr, "cairn: warning: another program has changed %s since Cairn wrote it\n", path.c_str());
}

BlobFile ReadFile(const std::string& path, bool changed_too) {
  BlobFile file = Take(ReadBlobFile(path, {.only = {}, .without = {}, .changed_too = true}));
  try {
    CheckKind(file.blob, file.kind);
  } catch (const InputError& error) {
    throw InputError(path + ": " + error.what());
  }
  if (!file.changed) return file;
  const Kind* kind = FindKind(file.kind);
  if (!changed_too && (kind == nullptr || !kind->is_given))
    throw InputError(
        path +
        ": another program has changed it since Cairn wrote it, so it is not what Cairn computed; "
        "--changed takes it as it is");
  WarnOfChanged(path);
  return file;
}

BlobFile ReadResult(const std::string& path, const std::string& kind, bool changed_too) {
  const std::string file = ResultPath(path, kind);
  BlobFile result = ReadFile(file, changed_too);
  if (result.kind != kind)
    throw InputError(file + ": " + WithArticle(result.kind) + ", where " + IsNeeded(kind));
  return result;
}

BlobFile ReadFirstOf(const std::string& path, const std::vector<std::string>& kinds, bool changed_too) {
  if (fs::is_regular_file(path)) return ReadFile(path, changed_too);
  std::set<std::string> there;
  for (const std::string& file : FilesOf(path)) there.insert(Take(ListBlobFile(file)).kind);
  const auto first =
      std::ranges::find_if(kinds, [&](const std::string& kind) { return there.contains(kind); });
  if (first == kinds.end()) throw InputError("there is none of " + Join(kinds) + " in '" + path + "'");
  return ReadResult(path, *first, changed_too);
}

}  // namespace cairn::cli
