// What the page of `view` is asked for, and the results that it shows, out of any bytes.
#pragma once

#include <filesystem>
#include <string>

namespace impactdic::fuzz {

// A request, "GET NAME?KEY=VALUE&..." or "POST NAME", and its body behind the first line. Nothing
// is measured.
void ask_page(const std::string& text, const std::filesystem::path& scratch);

// A fields.h5 and a job.toml, as the page reads them.
void show_fields(const std::filesystem::path& path);
void show_job(const std::filesystem::path& path);

}  // namespace impactdic::fuzz
