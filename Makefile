# Two commands do everything on a fresh Debian 12 machine: `make demo` and `make test`.

.PHONY: help setup build demo test check verify bench sanitize format tidy clean

help:
	@echo "make demo      install what is missing, build, compare heuristics on an embedded scene"
	@echo "make test      install what is missing, build, run all tests, with and without sanitizers"
	@echo "make check     the optimized build and its tests only"
	@echo "make verify    the long exactness checks (minutes)"
	@echo "make bench     the benchmarks"
	@echo "make format    format the sources;  make tidy: lint them"

setup:
	@tools/setup

build: setup
	@cmake --preset release >/dev/null
	@cmake --build --preset release

demo: setup
	@cmake --preset release >/dev/null
	@cmake --build --preset release --target raywise_app
	@tools/demo build/release/bin/raywise out/demo

test: setup
	@tools/run_tests release asan tsan

check: setup
	@tools/run_tests release

sanitize: setup
	@tools/run_tests asan tsan

verify: setup
	@cmake --preset release >/dev/null
	@cmake --build --preset release --target raywise_verify
	@build/release/bin/raywise_verify

bench: build
	@build/release/bin/bench_build_binned

format: setup
	@git ls-files '*.hpp' '*.cpp' | xargs clang-format-19 -i

tidy: setup
	@cmake --preset release >/dev/null
	@tools/tidy build/release

clean:
	@rm -rf build out
