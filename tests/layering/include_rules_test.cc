#include "tests/layering/include_rules.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace cairn::layering {
namespace {

namespace fs = std::filesystem;

// A source tree of one file, gone at the end of the test.
class PlantedTree {
 public:
  PlantedTree(const std::string& file, const std::string& text)
      : root_(fs::path(testing::TempDir()) / Name()) {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text;
  }
  ~PlantedTree() { fs::remove_all(root_); }
  std::vector<Finding> Find() const {
    int files = 0;
    std::vector<Finding> findings = FindWrongIncludes(root_, &files);
    EXPECT_EQ(files, 1);
    return findings;
  }

 private:
  static std::string Name() { return "cairn_planted_" + std::to_string(getpid()); }
  fs::path root_;
};

TEST(IncludeRules, HoldInTheWholeTree) {
  int files = 0;
  std::string text;
  for (const Finding& finding : FindWrongIncludes(CAIRN_SOURCE_DIR, &files)) text += ToText(finding) + "\n";
  EXPECT_EQ(text, "");
  EXPECT_GT(files, 20) << "the sources are not where this test looks";
}

TEST(IncludeRules, FindAPlantedIncludeWithItsLine) {
  const PlantedTree tree("worker/a.cc",
                         "// one\n#include \"schema/blob.h\"\n#include \"coordinator/core/core.h\"\n");
  const std::vector<Finding> findings = tree.Find();
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].file, "worker/a.cc");
  EXPECT_EQ(findings[0].line, 3);
  EXPECT_EQ(findings[0].include, "coordinator/core/core.h");
}

struct Case {
  const char* file;
  const char* include;
  bool allowed;
};

class IncludeRulesTable : public testing::TestWithParam<Case> {};

TEST_P(IncludeRulesTable, SaysWhoMayIncludeWhat) {
  const PlantedTree tree(GetParam().file, std::string("#include ") + GetParam().include + "\n");
  EXPECT_EQ(tree.Find().empty(), GetParam().allowed) << GetParam().file << " " << GetParam().include;
}

INSTANTIATE_TEST_SUITE_P(
    Folders, IncludeRulesTable,
    testing::Values(
        Case{"schema/a.cc", "\"schema/store/file.h\"", false}, Case{"schema/a.cc", "<hdf5.h>", false},
        Case{"schema/store/a.cc", "<hdf5.h>", true}, Case{"schema/store/a.cc", "<zmq.h>", false},
        Case{"schema/wire/a.cc", "<zmq.hpp>", true}, Case{"pipelines/x/a.cc", "\"schema/blob.h\"", true},
        Case{"pipelines/x/a.cc", "\"schema/store/file.h\"", false},
        Case{"pipelines/x/a.cc", "<fstream>", false}, Case{"pipelines/x/a.cc", "<thread>", false},
        Case{"pipelines/x/a.cc", "<spdlog/spdlog.h>", false},
        Case{"pipelines/x/a_test.cc", "<fstream>", true},
        Case{"pipelines/x/a_test.cc", "\"pipelines/testing/in_process.h\"", true},
        Case{"pipelines/x/a.cc", "\"pipelines/x/testing.h\"", false},
        Case{"coordinator/core/a.cc", "\"coordinator/core/testing/core_fixture.h\"", false},
        Case{"pipelines/landmark_map/a.cc", "\"pipelines/common/motion.h\"", true},
        Case{"pipelines/landmark_map/a.cc", "\"pipelines/forward_map/tiles.h\"", false},
        Case{"pipelines/landmark_map/a.cc", "\"pipelines/registry.h\"", false},
        Case{"pipelines/landmark_map/model/a.cc", "\"pipelines/landmark_map/state/schedule.h\"", false},
        Case{"pipelines/local_map/grids/a.cc", "\"pipelines/local_map/traces/match.h\"", false},
        Case{"pipelines/x/a_test.cc", "\"worker/worker.h\"", false},
        Case{"datasets/simulate/corridor/a.cc", "\"pipelines/pipeline.h\"", false},
        Case{"datasets/simulate/corridor/a.cc", "\"pipelines/image_features/band_features.h\"", true},
        Case{"datasets/simulate/a.cc", "\"pipelines/image_features/band_features.h\"", false},
        Case{"datasets/import/a.cc", "\"datasets/common/control.h\"", true},
        Case{"datasets/import/a.cc", "\"datasets/simulate/loop.h\"", false},
        Case{"datasets/import/a_test.cc", "\"datasets/simulate/loop.h\"", true},
        Case{"datasets/evaluate/a.cc", "\"datasets/simulate/loop.h\"", false},
        Case{"datasets/evaluate/a.cc", "\"datasets/report/drawing/style.h\"", false},
        Case{"datasets/common/a.cc", "\"datasets/import/csv.h\"", false},
        Case{"worker/a.cc", "\"pipelines/registry.h\"", true},
        Case{"worker/a.cc", "\"pipelines/landmark_map/model/e_step.h\"", false},
        Case{"coordinator/a.cc", "\"worker/worker.h\"", false},
        Case{"coordinator/server/a.cc", "\"datasets/csv.h\"", false},
        Case{"coordinator/server/a_test.cc", "\"datasets/csv.h\"", false},
        Case{"coordinator/core/a.cc", "\"coordinator/store/folder.h\"", false},
        Case{"coordinator/core/a.cc", "\"schema/wire/socket.h\"", false},
        Case{"coordinator/core/a.cc", "<fstream>", false},
        Case{"coordinator/core/a_test.cc", "\"schema/wire/socket.h\"", true},
        Case{"coordinator/store/a.cc", "\"coordinator/core/core.h\"", true},
        Case{"coordinator/store/a.cc", "\"coordinator/server/server.h\"", false},
        Case{"coordinator/store/a_test.cc", "\"coordinator/server/server.h\"", true},
        Case{"coordinator/cli/commands/a.cc", "\"datasets/csv.h\"", true},
        Case{"coordinator/cli/output/a.cc", "\"datasets/csv.h\"", false},
        Case{"coordinator/cli/output/a_test.cc", "\"datasets/csv.h\"", true},
        Case{"coordinator/cli/commands/import/a.cc", "\"coordinator/cli/commands/run.h\"", false},
        Case{"coordinator/cli/commands/a.cc", "\"pipelines/registry.h\"", false},
        Case{"coordinator/cli/a.cc", "<unheard/of.h>", false}));

}  // namespace
}  // namespace cairn::layering
