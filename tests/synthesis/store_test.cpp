#include "synthesis/store.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include "catalog/diagnostics.hpp"

namespace polyglide {
namespace {

const StoreIdentity kIdentity = {{"space", "abc"}, {"seed", "1"}};

// A file in the working folder, named after the test: a test that dies on purpose
// is started a second time and must find the same file.
class StoreTest : public ::testing::Test {
 protected:
  StoreTest() : file_(name()) {
    if (!::testing::internal::InDeathTestChild()) remove();
  }
  ~StoreTest() override {
    if (!::testing::internal::InDeathTestChild()) remove();
  }
  static std::string name() {
    return std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + ".db";
  }
  void remove() const {
    for (const char* part : {"", "-wal", "-shm"}) std::filesystem::remove(file_.string() + part);
  }
  std::string refusal(const StoreIdentity& identity) const {
    try {
      Store store(file_, identity);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path file_;
};

TEST_F(StoreTest, GivesBackWhatWasPut) {
  Store store(file_, kIdentity);
  EXPECT_EQ(store.find("verdict", "a"), std::nullopt);
  store.put("verdict", "a", R"({"x": 1})");
  store.put("tuning", "a", "other kind");
  store.put("verdict", "b", "old");
  store.put("verdict", "b", "new");
  EXPECT_EQ(store.find("verdict", "a"), R"({"x": 1})");
  EXPECT_EQ(store.find("tuning", "a"), "other kind");
  EXPECT_EQ(store.all("verdict"),
            (std::map<std::string, std::string>{{"a", R"({"x": 1})"}, {"b", "new"}}));
}

TEST_F(StoreTest, KeepsEverythingWhenClosedAndOpenedAgain) {
  {
    Store store(file_, kIdentity);
    for (int i = 0; i < 1000; ++i) store.put("verdict", std::to_string(i), "done");
  }
  Store store(file_, kIdentity);
  EXPECT_EQ(store.all("verdict").size(), 1000);
}

TEST_F(StoreTest, LosesNothingFinishedHalfASecondBeforeItIsKilled) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto work_until_killed = [&] {
    Store store(file_, kIdentity);
    for (int i = 0; i < 100; ++i) store.put("verdict", std::to_string(i), "done");
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    std::raise(SIGKILL);
  };
  EXPECT_EXIT(work_until_killed(), ::testing::KilledBySignal(SIGKILL), "");
  Store store(file_, kIdentity);
  EXPECT_EQ(store.all("verdict").size(), 100);
}

TEST_F(StoreTest, MayBeUsedFromManyThreads) {
  Store store(file_, kIdentity);
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&store, t] {
        for (int i = 0; i < 100; ++i)
          store.put("verdict", std::to_string(100 * t + i), std::to_string(t));
      });
  }
  EXPECT_EQ(store.all("verdict").size(), 400);
}

TEST_F(StoreTest, RefusesAnotherCampaignAndSaysWhatDiffers) {
  { Store store(file_, kIdentity); }
  EXPECT_EQ(refusal(kIdentity), "");
  const std::string said = refusal({{"space", "xyz"}, {"seed", "2"}});
  EXPECT_NE(said.find("its space is abc, this run's is xyz"), std::string::npos) << said;
  EXPECT_NE(said.find("its seed is 1, this run's is 2"), std::string::npos) << said;
}

TEST_F(StoreTest, RefusesAFileThatIsNoStore) {
  std::ofstream(file_) << "This is a letter to my aunt, and long enough to be one.";
  EXPECT_NE(refusal(kIdentity).find("must be a campaign store"), std::string::npos)
      << refusal(kIdentity);
}

TEST_F(StoreTest, RefusesAFolderThatCannotBe) {
  std::ofstream(file_) << "a file";
  try {
    Store store(file_ / "inside" / "store.db", kIdentity);
    FAIL() << "opened a store inside a file";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("folder"), std::string::npos) << error.what();
  }
}

TEST_F(StoreTest, MakesMissingFolders) {
  const std::filesystem::path folder = "MakesMissingFolders.dir";
  { Store store(folder / "a" / "b.db", kIdentity); }
  EXPECT_TRUE(std::filesystem::exists(folder / "a" / "b.db"));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace polyglide
