"""Another user of this machine, who tries to run code through the ports of a cluster of dask.

`python intruder.py plain PORT ...` connects without a certificate, `python intruder.py forged PORT ...` with one that
it made itself. Each line of output is a user whose process ran its code. All imports come first: the other user may
not be able to read them.
"""

import asyncio
import os
import pickle
import signal
import sys

from distributed import Client, Security, rpc

NOBODY = 65534  # user id without rights on any Unix
PATIENCE = 10  # [s] for one attempt


async def run_in_worker(address: str, security: Security) -> int:
    """Return the user that a worker or nanny at this address runs code as."""
    async with rpc(address, connection_args=security.get_connection_args("client")) as door:
        answer = await door.run(function=pickle.dumps(os.getuid))
        return int(answer["result"])


async def run_in_cluster(address: str, security: Security) -> int:
    """Return the user that a worker of the scheduler at this address runs code as."""
    async with Client(address, security=security, timeout=PATIENCE, asynchronous=True) as client:
        return int(await client.submit(os.getuid))


def main(kind: str, ports: list[str]) -> None:
    """Try both ways at every port, as another user where the system allows that."""
    security = Security.temporary() if kind == "forged" else Security()
    scheme = "tls" if kind == "forged" else "tcp"
    if os.getuid() == 0:
        os.setgroups([])
        os.setgid(NOBODY)
        os.setuid(NOBODY)
    for port in ports:
        for attempt in (run_in_worker, run_in_cluster):
            if os.fork() == 0:
                signal.alarm(PATIENCE)  # ends this process: an HTTP port leaves the question unanswered
                user = asyncio.run(attempt(f"{scheme}://127.0.0.1:{port}", security))
                sys.stdout.write(f"{user}\n")
                sys.stdout.flush()
                os._exit(0)
    for _ in ports:
        os.wait()
        os.wait()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
