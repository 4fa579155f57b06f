"""Program of another user that attacks a dask cluster's ports.

`python intruder.py plain PORT ...` connects without a certificate, `python intruder.py forged PORT ...` with one that
it made itself, and `plain,forged` in both ways. Each line of output is a user whose process ran its code. All imports
come first: the other user may not be able to read them.
"""

import asyncio
import os
import pickle
import signal
import sys
from itertools import product

from distributed import Client, Security, rpc

NOBODY = 65534  # user id without rights on any Unix
PATIENCE = 10  # [s] longest duration of one attack


async def run_in_worker(address: str, security: Security) -> int:
    """Return the user as which a worker or nanny at an address runs code."""
    async with rpc(address, connection_args=security.get_connection_args("client")) as door:
        answer = await door.run(function=pickle.dumps(os.getuid))
        return int(answer["result"])


async def run_in_cluster(address: str, security: Security) -> int:
    """Return the user as which a worker of the scheduler at an address runs code."""
    async with Client(address, security=security, timeout=PATIENCE, asynchronous=True) as client:
        return int(await client.submit(os.getuid))


def main(kinds: list[str], ports: list[str]) -> None:
    """Try every attack on every port, as another user where the system allows it."""
    ways = {"plain": ("tcp", Security), "forged": ("tls", Security.temporary)}
    doors = [(scheme, make_security()) for scheme, make_security in (ways[kind] for kind in kinds)]
    if os.getuid() == 0:
        os.setgroups([])
        os.setgid(NOBODY)
        os.setuid(NOBODY)
    for port in ports:
        for (scheme, security), attempt in product(doors, (run_in_worker, run_in_cluster)):
            if os.fork() == 0:
                signal.alarm(PATIENCE)  # ends this process: an HTTP port leaves the question unanswered
                user = asyncio.run(attempt(f"{scheme}://127.0.0.1:{port}", security))
                sys.stdout.write(f"{user}\n")
                sys.stdout.flush()
                os._exit(0)
    for _ in range(len(ports) * len(doors) * 2):
        os.wait()


if __name__ == "__main__":
    main(sys.argv[1].split(","), sys.argv[2:])
