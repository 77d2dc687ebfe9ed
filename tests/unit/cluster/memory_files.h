// A file system in memory that counts what is asked of it.
#pragma once

#include <impactdic/error.h>

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/cluster/files.h"

namespace impactdic::testing {

class MemoryFiles : public cluster::Files {
 public:
  bool move(const std::string& from, const std::string& to) override {
    ++operations;
    if (folders_.count(parent(to)) == 0) return false;
    if (folders_.count(from) != 0) {
      if (folders_.count(to) != 0 && !names_under(to).empty()) return false;
      rename_all(from, to);
      return true;
    }
    const auto found = files_.find(from);
    if (found == files_.end()) return false;
    std::string text = found->second;
    drop(from);
    put(to, std::move(text));
    return true;
  }
  bool make_folder(const std::string& path) override {
    ++operations;
    if (!folders_.insert(path).second) return false;
    children_[parent(path)].insert(path.substr(path.rfind('/') + 1));
    return true;
  }
  bool remove_folder(const std::string& path) override {
    ++operations;
    if (folders_.count(path) == 0 || !names_under(path).empty()) return false;
    folders_.erase(path);
    children_[parent(path)].erase(path.substr(path.rfind('/') + 1));
    return true;
  }
  bool remove(const std::string& path) override {
    ++operations;
    return drop(path);
  }
  bool exists(const std::string& path) override {
    ++operations;
    return files_.count(path) != 0 || folders_.count(path) != 0;
  }
  // NFS lists a folder in pages: each counts.
  std::vector<std::string> names_in(const std::string& folder) override {
    constexpr std::size_t kPage = 128;
    const std::set<std::string>& names = names_under(folder);
    operations += 1 + names.size() / kPage;
    return {names.begin(), names.end()};
  }
  std::optional<std::string> read(const std::string& path) override {
    ++operations;
    const auto found = files_.find(path);
    return found == files_.end() ? std::nullopt : std::optional<std::string>(found->second);
  }
  void write(const std::string& path, const std::string& text) override {
    ++operations;
    if (folders_.count(parent(path)) == 0) throw FileError("there is no such folder", path);
    put(path, text);
  }

  std::size_t operations = 0;
  const std::map<std::string, std::string>& files() const { return files_; }

 private:
  static std::string parent(const std::string& path) {
    const std::size_t slash = path.rfind('/');
    return slash == std::string::npos ? "" : path.substr(0, slash);
  }
  const std::set<std::string>& names_under(const std::string& folder) { return children_[folder]; }
  void put(const std::string& path, std::string text) {
    files_[path] = std::move(text);
    children_[parent(path)].insert(path.substr(path.rfind('/') + 1));
  }
  bool drop(const std::string& path) {
    if (files_.erase(path) == 0) return false;
    children_[parent(path)].erase(path.substr(path.rfind('/') + 1));
    return true;
  }
  void rename_all(const std::string& from, const std::string& to) {
    const std::set<std::string> names = children_[from];
    folders_.insert(to);
    children_[parent(to)].insert(to.substr(to.rfind('/') + 1));
    for (const std::string& name : names) {
      const std::string inside = from + "/" + name, outside = to + "/" + name;
      if (folders_.count(inside) != 0) {
        rename_all(inside, outside);
      } else {
        put(outside, files_[inside]);
        drop(inside);
      }
    }
    folders_.erase(from);
    children_[from].clear();
    children_[parent(from)].erase(from.substr(from.rfind('/') + 1));
  }

  std::map<std::string, std::string> files_;
  std::set<std::string> folders_ = {""};
  std::map<std::string, std::set<std::string>> children_;
};

}  // namespace impactdic::testing
