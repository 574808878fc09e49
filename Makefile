# The face of the build; CMake and Ninja do the work. Each goal first installs what it misses (tools/setup).
#
#   make            the program, at build/laves
#   make demo       meshes the bundled inputs in demo/ and draws them, into build/demo/
#   make check      builds and runs all tests
#   make bench      measures quality and speed, and draws README's table
#   make docs       the documentation as a site, at build/site
#   make install    installs program, library, header and package files under PREFIX (/usr/local)
#   make packages   Debian packages and a tar, into build-package/
#   make format     lays out the C sources by .clang-format, lists them in src/README.md, and renews docs/api.md
#   make clean      removes build/
#   make help       prints this

BUILD ?= build
PREFIX ?= /usr/local
JOBS ?= $(shell nproc 2>/dev/null || echo 2)

# The tests are configured by `make check` only, so that the program alone needs fewer packages.
FIRST_TIME = $(if $(wildcard $(BUILD)/CMakeCache.txt),,-DLAVES_TESTS=OFF)

all:
	@tools/setup build
	@cmake -S . -B $(BUILD) -G Ninja --log-level=WARNING $(FIRST_TIME)
	@cmake --build $(BUILD) --parallel $(JOBS)

demo: all
	@demo/run $(BUILD)/laves $(BUILD)/demo

check:
	@tools/setup check
	@cmake -S . -B $(BUILD) -G Ninja --log-level=WARNING -DLAVES_TESTS=ON
	@cmake --build $(BUILD) --parallel $(JOBS)
	@ctest --test-dir $(BUILD) --output-on-failure --parallel $(JOBS)

bench: all
	@tools/setup bench
	@cmake --build $(BUILD) --parallel $(JOBS) --target laves-measure laves-judge laves-floor laves-bumps
	@bench/run $(BUILD)/laves --readme

docs:
	@tools/setup docs
	@tools/make_site $(BUILD)/site

install: all
	@cmake --install $(BUILD) --prefix $(PREFIX)

format:
	@git ls-files '*.c' '*.h' ':!src/background/c15_table.c' | xargs clang-format -i
	@tools/source_list.py --write
	@tools/api_reference.py --write

packages:
	@tools/setup packages
	@cmake --preset package --log-level=WARNING
	@cmake --build --preset package --parallel $(JOBS)
	@cmake --build --preset package --target package

clean:
	@rm -rf $(BUILD)

help:
	@sed -n '3,/^$$/s/^# \{0,1\}//p' Makefile

.PHONY: all demo check bench docs install packages format clean help
