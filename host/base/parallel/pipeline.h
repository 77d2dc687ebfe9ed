// Items that go through stages of work on several threads, with oneTBB.
#pragma once

#include <tbb/parallel_pipeline.h>

#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "host/base/parallel/order.h"

namespace impactdic {

template <typename Work>
struct PipelineStage {
  tbb::filter_mode mode;
  Work work;
};

// A stage that takes one item at a time, in the order in which they came from `next`.
template <typename Work>
PipelineStage<Work> in_order(Work work) {
  return {tbb::filter_mode::serial_in_order, std::move(work)};
}

// A stage that takes several items at a time.
template <typename Work>
PipelineStage<Work> several_at_once(Work work) {
  return {tbb::filter_mode::parallel, std::move(work)};
}

namespace detail {

// An item between two stages: who takes it follows who made it.
template <typename Item>
class Carried {
 public:
  explicit Carried(Item item) : item_(std::move(item)) { order::pass_on(this); }
  Carried(Carried&& other) noexcept : item_(other.take()) { order::pass_on(this); }
  Carried& operator=(Carried&&) = delete;
  ~Carried() { order::follow(this); }

  Item take() {
    order::follow(this);
    return std::move(item_);
  }

 private:
  Item item_;
};

// While a thread is in a stage. `turn`: of a stage in order, otherwise null.
class InStage {
 public:
  InStage(const char* turn, const char* ended) : turn_(turn), ended_(ended) {
    if (turn_ != nullptr) order::follow(turn_);
  }
  ~InStage() {
    if (turn_ != nullptr) order::pass_on(turn_);
    order::pass_on(ended_);
  }
  InStage(const InStage&) = delete;
  InStage& operator=(const InStage&) = delete;

 private:
  const char *turn_, *ended_;
};

// Who waits for all follows all, thrown exceptions too.
class Ending {
 public:
  explicit Ending(const char* ended) : ended_(ended) {}
  ~Ending() { order::follow(ended_); }
  Ending(const Ending&) = delete;
  Ending& operator=(const Ending&) = delete;

 private:
  const char* ended_;
};

// Builds the stages from the first to the last, then runs them. Addresses stand for the order
// (order.h): of `turns`, one for each stage that is left, and of `ended`.
template <typename Item, typename Chain, typename First, typename... Rest>
void run_stages(std::size_t most_items, const Chain& before, const char* turns, const char* ended,
                PipelineStage<First> first, PipelineStage<Rest>... rest) {
  using Result = std::invoke_result_t<const First&, Item>;
  const char* turn = first.mode == tbb::filter_mode::parallel ? nullptr : turns;
  if constexpr (sizeof...(Rest) == 0) {
    static_assert(std::is_void_v<Result>, "the last stage has nobody to give its result to");
    const auto run = order::Handed([=, work = std::move(first.work)](Carried<Item> item) {
      const InStage here(turn, ended);
      work(item.take());
    });
    tbb::parallel_pipeline(most_items,
                           before & tbb::make_filter<Carried<Item>, void>(first.mode, run));
  } else {
    const auto run = order::Handed([=, work = std::move(first.work)](Carried<Item> item) {
      const InStage here(turn, ended);
      return Carried<Result>(work(item.take()));
    });
    const auto longer = before & tbb::make_filter<Carried<Item>, Carried<Result>>(first.mode, run);
    run_stages<Result>(most_items, longer, turns + 1, ended, std::move(rest)...);
  }
}

}  // namespace detail

// Calls `next` until what it returns is empty (a pointer or an optional), and hands each item
// through the stages: a stage is called with what the one before returned, the last returns
// nothing. At most `most_items` are on their way. The first exception ends the pipeline and is
// thrown again here.
template <typename Next, typename... Works>
void run_pipeline(std::size_t most_items, const Next& next, PipelineStage<Works>... stages) {
  using Item = std::invoke_result_t<const Next&>;
  using detail::Carried;
  const std::array<char, sizeof...(Works) + 1> turns{};
  const char ended = 0;
  order::pass_on(turns.data());
  const auto begin = order::Handed([&](tbb::flow_control& control) {
    const detail::InStage here(turns.data(), &ended);
    Item item = next();
    if (!item) control.stop();
    return Carried<Item>(std::move(item));
  });
  const auto first =
      tbb::make_filter<void, Carried<Item>>(tbb::filter_mode::serial_in_order, begin);
  const detail::Ending ending(&ended);
  detail::run_stages<Item>(most_items, first, turns.data() + 1, &ended, std::move(stages)...);
}

}  // namespace impactdic
