// What keeps results whole and lets nobody in: journals, locks, digests, limits, private folders.
#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "host/base/csv_table.h"
#include "host/base/private_folder.h"
#include "host/base/toml_text.h"
#include "host/report/fields_file.h"
#include "host/report/journaled_file.h"
#include "host/report/shots_csv.h"
#include "host/run/batch/shot_line.h"
#include "host/run/results/folder_lock.h"
#include "host/run/results/result_digests.h"
#include "host/video/picture_size.h"
#include "tests/support/scratch.h"

namespace impactdic {
namespace {

namespace fs = std::filesystem;
using report::JournaledFile;
using testing::read_text;
using testing::ScratchFolder;

std::vector<std::uint8_t> bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

std::string content(JournaledFile& file) {
  std::vector<std::uint8_t> bytes(file.size());
  file.read(0, bytes);
  return {bytes.begin(), bytes.end()};
}

TEST(CsvTable, CellsInQuotationMarksMayHoldCommas) {
  const ScratchFolder folder;
  const fs::path file = folder / "table.csv";
  std::ofstream(file) << "name,note, \"size, mm\"\r\n"
                         "a, \"one, \"\"two\"\"\" ,3\r\n"
                         "b,6\" wide,\"\"\r\n";
  const CsvTable table = CsvTable::read(file);
  EXPECT_EQ(table.columns()[2], "size, mm");
  EXPECT_EQ(table.text("note"), (std::vector<std::string>{"one, \"two\"", "6\" wide"}));
  EXPECT_EQ(table.text("size, mm"), (std::vector<std::string>{"3", ""}));
  std::ofstream(file) << "name,note\na,\"one\nb,two\n";
  try {
    CsvTable::read(file);
    FAIL() << "a mark that is not closed was read";
  } catch (const FormatError& error) {
    EXPECT_NE(error.line().find("line 2"), std::string::npos) << error.line();
  }
}

TEST(CsvTable, LimitsAreCheckedBeforeMemoryIsTaken) {
  const ScratchFolder folder;
  const fs::path file = folder / "table.csv";
  const auto line_of = [&](const std::string& text, const TableLimits& limits) -> std::string {
    std::ofstream(file) << text;
    try {
      CsvTable::read(file, limits);
      return "";
    } catch (const FormatError& error) {
      return error.line();
    }
  };
  TableLimits small;
  small.cells = 6;
  small.columns = 3;
  EXPECT_EQ(line_of("a,b,c\n1,2,3\n4,5,6\n", small), "");
  EXPECT_NE(line_of("a,b,c\n1,2,3\n4,5,6\n7,8,9\n", small).find("6 cells"), std::string::npos);
  EXPECT_NE(line_of("a,b,c,d\n", small).find("3 columns"), std::string::npos);
  EXPECT_NE(line_of("a\n" + std::string(60, '1') + "\n", small).find("bytes"), std::string::npos);
  // So many columns that to compare each with each would take hours.
  std::string wide = "c";
  for (int i = 0; i < 2'000'000; ++i) wide += ",c" + std::to_string(i);
  EXPECT_NE(line_of(wide, {}).find("1000 columns"), std::string::npos);
}

TEST(CsvTable, APipeIsReadAsFarAsAFileMayGo) {
  const ScratchFolder folder;
  const fs::path pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const auto written = [&](std::size_t bytes) {
    return std::jthread([=] {
      std::ofstream out(pipe);
      out << "a\n" << std::string(bytes, '1') << "\n2\n";
    });
  };
  TableLimits small;
  small.cells = 100;
  {
    const std::jthread writer = written(20);
    EXPECT_EQ(CsvTable::read(pipe, small).rows(), 2u);
  }
  std::signal(SIGPIPE, SIG_IGN);
  const std::jthread writer = written(100'000'000);
  EXPECT_THROW(CsvTable::read(pipe, small), FormatError);
}

TEST(JournaledFile, ReadsWhatWasWrittenWhereverItLies) {
  const ScratchFolder folder;
  JournaledFile file = JournaledFile::create(folder / "a");
  std::mt19937 random(3);
  std::string want;
  for (int i = 0; i < 400; ++i) {
    const std::size_t at = random() % 20000, count = 1 + random() % 6000;
    const std::string text(count, static_cast<char>('a' + i % 26));
    if (want.size() < at + count) want.resize(at + count, '\0');
    want.replace(at, count, text);
    file.write(at, bytes_of(text));
    if (i % 37 == 0) file.commit();
    ASSERT_EQ(content(file), want) << i;
  }
  file.commit();
  EXPECT_EQ(read_text(folder / "a"), want);
  EXPECT_FALSE(fs::exists(JournaledFile::journal_of(folder / "a")));
}

TEST(JournaledFile, WhatIsNotCommittedLeavesTheFileAsItWas) {
  const ScratchFolder folder;
  {
    JournaledFile file = JournaledFile::create(folder / "a");
    file.write(0, bytes_of(std::string(10000, 'a')));
    file.commit();
    file.write(5000, bytes_of("changed"));
    file.resize(100);
  }
  EXPECT_EQ(read_text(folder / "a"), std::string(10000, 'a'));
}

// A child commits again and again and is killed in the middle of it.
TEST(JournaledFile, IsWholeHoweverItsWriterIsKilled) {
  const ScratchFolder folder;
  const fs::path path = folder / "a";
  constexpr int kBlocks = 40, kBlock = 1000;
  {
    JournaledFile file = JournaledFile::create(path);
    file.write(0, bytes_of(std::string(kBlocks * kBlock, 'z')));
    file.commit();
  }
  std::mt19937 random(7);
  for (int kill = 0; kill < 40; ++kill) {
    const pid_t child = ::fork();
    if (child == 0) {
      JournaledFile file = JournaledFile::open(path);
      for (unsigned round = 0;; ++round) {
        const std::string text(kBlock, static_cast<char>('a' + round % 26));
        for (int i = 0; i < kBlocks; ++i) {
          file.write(static_cast<std::uint64_t>(i) * kBlock, bytes_of(text));
        }
        file.commit();
      }
    }
    std::this_thread::sleep_for(std::chrono::microseconds(2000 + random() % 20000));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    // One and the same letter all through: no commit is there in part.
    JournaledFile file = JournaledFile::open(path);
    const std::string all = content(file);
    ASSERT_EQ(all.size(), static_cast<std::size_t>(kBlocks) * kBlock);
    ASSERT_EQ(all.find_first_not_of(all[0]), std::string::npos) << "kill " << kill;
  }
}

TEST(JournaledFile, ADamagedJournalIsRefused) {
  const ScratchFolder folder;
  std::ofstream(folder / "a") << "text";
  std::ofstream(JournaledFile::journal_of(folder / "a")) << std::string(200, 'x');
  EXPECT_THROW(JournaledFile::open(folder / "a"), FormatError);
}

// The frames before the last flush, whatever became of those behind it.
TEST(FieldsFile, AKilledWriterLeavesTheFramesThatItFlushed) {
  const ScratchFolder folder;
  const fs::path path = folder / "fields.h5";
  const std::vector<Window> windows(30);
  const std::vector<WindowMotion> field(30);
  for (const int compression : {0, 4}) {
    int made[2];
    ASSERT_EQ(::pipe(made), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      auto file = report::FieldsFile::create(path, 30, 15, {}, compression);
      for (int frame = 0; frame < 100000; ++frame) {
        file.add(frame, frame, windows, field, nullptr);
        if (frame % 50 != 49) continue;
        file.flush();
        if (::write(made[1], &frame, sizeof frame) < 0) break;
      }
      ::_exit(0);
    }
    int frame = 0;
    while (frame < 500) ASSERT_EQ(::read(made[0], &frame, sizeof frame), ssize_t{sizeof frame});
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    ::close(made[1]);
    for (int later = 0; ::read(made[0], &later, sizeof later) == ssize_t{sizeof later};) {
      frame = later;
    }
    ::close(made[0]);
    const auto rows = static_cast<std::size_t>(frame) + 1;
    {
      auto file = report::FieldsFile::resume(path, 15, rows);
      EXPECT_EQ(file.rows(), rows);
      // Shortened, but not flushed: as it was.
    }
    EXPECT_NO_THROW(report::FieldsFile::resume(path, 15, rows - 10));
  }
}

TEST(ContinueTable, KeepsRowsAndDropsThoseBehind) {
  const ScratchFolder folder;
  std::ofstream(folder / "a.csv") << "x,y\n1,2\n3,4\n5,6\n7,";
  continue_table(folder / "a.csv", "x,y", 2) << "8,9\n";
  EXPECT_EQ(read_text(folder / "a.csv"), "x,y\n1,2\n3,4\n8,9\n");
  EXPECT_THROW(continue_table(folder / "a.csv", "x,y", 4), FormatError);
  EXPECT_THROW(continue_table(folder / "a.csv", "x,z", 1), FormatError);
  EXPECT_EQ(read_text(folder / "a.csv"), "x,y\n1,2\n3,4\n8,9\n");
  continue_table(folder / "a.csv", "x,y", 0) << "1,1\n";
  EXPECT_EQ(read_text(folder / "a.csv"), "x,y\n1,1\n");
  // A version that wrote more columns goes on with the table of an older one.
  continue_table(folder / "a.csv", "x,y,z", 1) << "2,2,2\n";
  EXPECT_EQ(read_text(folder / "a.csv"), "x,y,z\n1,1,\n2,2,2\n");
  EXPECT_THROW(continue_table(folder / "a.csv", "x,y", 1), FormatError);
}

TEST(Digests, SayWhatWasChangedCutOffOrTakenAway) {
  const ScratchFolder folder;
  for (const char* name : {"track.csv", "pose.csv", "fields.h5", "job.toml"}) {
    std::ofstream(folder / name) << name << " as it was";
  }
  std::ofstream(folder / "notes.txt") << "a person's own";
  run::write_digests(folder / "");
  const auto state = [&](const std::string& name) {
    for (const auto& file : run::check_digests(folder / "").files) {
      if (file.file == name) return file.state;
    }
    throw std::runtime_error(name + " is not noted");
  };
  EXPECT_EQ(run::check_digests(folder / "").files.size(), 4u);
  EXPECT_EQ(run::check_digests(folder / "").version, IMPACTDIC_VERSION);
  for (const auto& file : run::check_digests(folder / "").files) {
    EXPECT_EQ(file.state, run::FileState::kSame) << file.file;
  }
  EXPECT_EQ(
      std::system(
          ("cd '" + folder.string() + "' && sha256sum -c --quiet --strict SHA256SUMS").c_str()),
      0);
  std::ofstream(folder / "track.csv") << "track.csv as it WAS";
  fs::resize_file(folder / "fields.h5", 5);
  fs::remove(folder / "pose.csv");
  EXPECT_EQ(state("track.csv"), run::FileState::kChanged);
  EXPECT_EQ(state("fields.h5"), run::FileState::kShorter);
  EXPECT_EQ(state("pose.csv"), run::FileState::kMissing);
  EXPECT_EQ(state("job.toml"), run::FileState::kSame);
}

TEST(Digests, NoNameLeadsOutOfTheFolder) {
  const ScratchFolder folder;
  EXPECT_THROW(run::check_digests(folder / ""), FileError);
  for (const char* name : {"../secret", "/etc/passwd", "a/../../b"}) {
    std::ofstream(folder / run::kDigestsName) << std::string(64, '0') << "  " << name << "\n";
    EXPECT_THROW(run::check_digests(folder / ""), FormatError) << name;
  }
}

TEST(TomlNesting, OrdinaryJobsPassAndDeepOnesDoNot) {
  const auto deep = [](const std::string& open, const std::string& close, int count) {
    std::string text = "a = ";
    for (int i = 0; i < count; ++i) text += open;
    text += "1";
    for (int i = 0; i < count; ++i) text += close;
    return text + "\n";
  };
  const std::string dots = [] {
    std::string text = "a";
    for (int i = 0; i < 60000; ++i) text += ".a";
    return text;
  }();
  EXPECT_NO_THROW(check_toml_nesting("a = 1.5\n[b.c]\nd = [1.0, 2.0]\n# " + dots, ""));
  EXPECT_NO_THROW(
      check_toml_nesting("a = '" + dots + "'\nb = \"" + dots + "\\\"" + dots + "\"", ""));
  EXPECT_NO_THROW(
      check_toml_nesting("a = '''\n" + dots + "\n'''\nb = \"\"\"" + dots + "\"\"\"", ""));
  EXPECT_NO_THROW(check_toml_nesting(deep("[", "]", 60), ""));
  EXPECT_THROW(check_toml_nesting(dots + " = 1", ""), InvalidArgument);
  EXPECT_THROW(check_toml_nesting("[" + dots + "]", ""), InvalidArgument);
  EXPECT_THROW(check_toml_nesting("a = {" + dots + " = 1}", ""), InvalidArgument);
  EXPECT_THROW(check_toml_nesting(deep("[", "]", 70), ""), InvalidArgument);
  EXPECT_THROW(check_toml_nesting(deep("{b=", "}", 70), ""), InvalidArgument);
  EXPECT_THROW(check_toml_nesting("a = '''x''' \n" + dots + " = 1", ""), InvalidArgument);
}

TEST(PictureSize, IsReadFromTheHeaderAlone) {
  const ScratchFolder folder;
  const auto size_of = [&](const std::string& bytes) {
    std::ofstream(folder / "a", std::ios::binary | std::ios::trunc) << bytes;
    const auto size = video::picture_size(video::ByteFile(folder.file("a")));
    return std::pair(size.width, size.height);
  };
  const std::string rest(64, '\0');
  const std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x27\x10\0\0\0\x05", 24);
  EXPECT_EQ(size_of(png + rest), std::pair(std::int64_t{10000}, std::int64_t{5}));
  EXPECT_EQ(size_of("P5 # 9 9\n# 7\n640 480\n255\n" + rest),
            std::pair(std::int64_t{640}, std::int64_t{480}));
  const std::string jpeg("\xff\xd8\xff\xe0\0\x04zz\xff\xc0\0\x11\x08\x01\x02\x03\x04", 17);
  EXPECT_EQ(size_of(jpeg + rest), std::pair(std::int64_t{0x304}, std::int64_t{0x102}));
  const std::string bmp = "BM" + std::string(12, '\0') + std::string("\x28\0\0\0", 4) +
                          std::string("\x07\0\0\0\xfb\xff\xff\xff\x01\0\x08\0", 12);
  EXPECT_EQ(size_of(bmp + rest), std::pair(std::int64_t{7}, std::int64_t{5}));
  const std::string endless = bmp.substr(0, 18) + std::string(8, '\x7f') + bmp.substr(26);
  EXPECT_THROW(size_of(endless + rest), FormatError);  // no count holds the product of its sides
  EXPECT_THROW(size_of("P5 x"), FormatError);
  EXPECT_THROW(size_of("\xff\xd8\xff" + std::string(40, 'x')), FormatError);
  EXPECT_THROW(video::check_megapixels("a", 10000, 10000, 40), FormatError);
  EXPECT_NO_THROW(video::check_megapixels("a", 10000, 10000, 100));
}

TEST(ShotsCsv, NoCellIsTakenForAFormula) {
  ShotResult shot;
  shot.file = "=HYPERLINK(\"http://x\").tif";
  shot.name = "-1+cmd|' /C calc'!A0";
  shot.reason = "@SUM(1,2)\n=3";
  shot.drop_height_mm = "-250.5";
  shot.notes = " +1+1";
  const std::string line = report::shots_csv_line(shot);
  EXPECT_EQ(line.rfind("'=HYPERLINK('http://x').tif,'-1+cmd|' /C calc'!A0,failed,'@SUM(1;2) =3,,"
                       "-250.5,' +1+1,",
                       0),
            0u)
      << line;
}

// get<unsigned>() of such a number is undefined; a reader of tickets is told that it is damaged.
TEST(ShotLine, ANumberThatIsNoCharacterIsDamage) {
  run::BatchShot shot;
  shot.clip = "a.cine";
  shot.drop_height_mm = "50";
  const std::string line = run::to_line(shot);
  EXPECT_EQ(run::to_line(run::parse_shot_line(line, "ticket")), line);
  for (const char* wrong : {"7e95", "[7e95]", "[0.5]", "{}x"}) {
    std::string damaged = line;
    const std::string was = "\"drop_height_mm\":\"50\"";
    const std::size_t at = damaged.find(was);
    ASSERT_NE(at, std::string::npos);
    damaged.replace(at, was.size(), std::string("\"drop_height_mm\":") + wrong);
    EXPECT_THROW(run::parse_shot_line(damaged, "ticket"), FormatError) << wrong;
  }
}

TEST(PrivateFolder, IsForItsOwnerAlone) {
  const ScratchFolder folder;
  const auto mode = [](const fs::path& path) {
    struct stat found = {};
    ::stat(path.c_str(), &found);
    return found.st_mode & 0777;
  };
  ASSERT_TRUE(make_private_folder(folder / "deep/cache"));
  EXPECT_EQ(mode(folder / "deep/cache"), 0700u);
  fs::create_directory(folder / "lax");
  ::chmod((folder / "lax").c_str(), 0775);
  EXPECT_TRUE(is_trusted_folder(folder / "lax"));
  EXPECT_EQ(mode(folder / "lax"), 0755u);
  ::chmod((folder / "lax").c_str(), 0777);
  EXPECT_FALSE(is_trusted_folder(folder / "lax"));
  EXPECT_FALSE(make_private_folder(folder / "lax"));
  EXPECT_FALSE(is_trusted_folder(folder / "nowhere"));
  std::ofstream(folder / "file") << "x";
  EXPECT_FALSE(make_private_folder(folder / "file"));
}

}  // namespace
}  // namespace impactdic
