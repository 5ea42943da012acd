"""Pages for the benchmarks: processes that connect to a server and read what it sends, as fast as it comes."""

from __future__ import annotations

import asyncio
import json
import subprocess
import sys
from contextlib import contextmanager
from typing import Any
from urllib.parse import urlsplit
from urllib.request import urlopen


def welcome(address: str) -> tuple[str, str]:
    """The host and the cookie of a server's address."""
    with urlopen(address) as response:
        return urlsplit(address).netloc, response.headers["Set-Cookie"].partition(";")[0]


def socket_options(host: str, cookie: str) -> dict[str, Any]:
    """What a client of `websockets` needs to connect as a page does."""
    return {
        "uri": f"ws://{host}/ws",
        "additional_headers": {"Cookie": cookie},
        "origin": f"http://{host}",
        "compression": None,
        "max_size": None,
        "proxy": None,
    }


async def watch(host: str, cookie: str, totals: list[int]) -> None:
    from websockets.asyncio.client import connect

    async with connect(**socket_options(host, cookie)) as socket:
        async for data in socket:
            totals[0] += len(data)
            if json.loads(data)["type"] == "frame":
                totals[1] += 1


async def main(address: str, pages: int) -> None:
    host, cookie = welcome(address)
    totals = [0, 0]
    watching = [asyncio.create_task(watch(host, cookie, totals)) for _ in range(pages)]
    print("open", flush=True)
    await asyncio.get_running_loop().run_in_executor(None, sys.stdin.readline)
    for task in watching:
        task.cancel()
    await asyncio.gather(*watching, return_exceptions=True)
    print(*totals, flush=True)


@contextmanager
def open_pages(address: str, pages: int):
    """Open pages in another process; yields what closes them, and returns the bytes and frames that they got."""
    process = subprocess.Popen(
        [sys.executable, __file__, address, str(pages)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    process.stdout.readline()

    def close() -> tuple[int, int]:
        out, _ = process.communicate("\n", timeout=30)
        size, frames = out.split()
        return int(size), int(frames)

    try:
        yield close
    finally:
        process.kill()


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1], int(sys.argv[2])))
