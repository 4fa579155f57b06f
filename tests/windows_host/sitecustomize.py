"""A simulated Windows for the code of kinesic, in this process and in the processes that it starts.

The folder of this file is put into PYTHONPATH. Modules of kinesic then see other modules than those of the libraries:
`sys.platform` is "win32", modules of POSIX are missing, and so are attributes of `os`, `signal`, `select`, `socket` and
`multiprocessing` that Windows lacks. Libraries see the real system, on which they run. What only a real Windows does,
such as refusing to rename an open file, is not simulated.
"""

import builtins
import multiprocessing.connection
import os
import signal
import sys
from collections.abc import Callable, Mapping
from types import ModuleType

MISSING_MODULES = frozenset({"fcntl", "grp", "pty", "pwd", "resource", "syslog", "termios", "tty"})
MISSING_ATTRIBUTES = {
    "os": frozenset(
        {
            *("O_DIRECTORY", "O_NOFOLLOW", "O_NONBLOCK", "O_CLOEXEC", "PRIO_PROCESS", "SCHED_FIFO", "chown", "fchmod"),
            *("fork", "getegid", "geteuid", "getgid", "getloadavg", "getpgid", "getpriority", "getuid", "killpg"),
            *("memfd_create", "mkfifo", "nice", "openpty", "pread", "pwrite", "sched_getaffinity", "sched_param"),
            *("sched_setscheduler", "set_blocking", "setpgid", "setpriority", "setsid", "sysconf", "ttyname", "uname"),
        }
    ),
    "signal": frozenset(
        {
            *("SIGALRM", "SIGCHLD", "SIGHUP", "SIGKILL", "SIGPIPE", "SIGQUIT", "SIGSTOP", "SIGTSTP", "SIGUSR1"),
            *("SIGUSR2", "SIGWINCH", "SIGXCPU", "SIG_BLOCK", "SIG_SETMASK", "SIG_UNBLOCK", "alarm", "pthread_kill"),
            *("pthread_sigmask", "setitimer"),
        }
    ),
    "select": frozenset({"POLLHUP", "POLLIN", "POLLOUT", "epoll", "poll"}),
    "socket": frozenset({"AF_UNIX", "SO_PEERCRED"}),
    "multiprocessing.context": frozenset({"ForkContext", "ForkServerContext"}),
    "multiprocessing": frozenset({"forkserver"}),
}


def without_descriptors(name: str) -> Callable[..., object]:
    """Return a function of `os` that refuses descriptors of folders, as on Windows."""
    original = getattr(os, name)

    def refuse(*arguments: object, **options: object) -> object:
        for option in ("dir_fd", "src_dir_fd", "dst_dir_fd"):
            if options.pop(option, None) is not None:
                # CPython raises this error on Windows, so the simulated host does as well.
                raise NotImplementedError(f"{option} unavailable on this platform")
        if name == "open" and os.path.isdir(str(arguments[0])):
            raise PermissionError(13, "Permission denied", str(arguments[0]))
        return original(*arguments, **options)

    return refuse


def only_spawned(method: str | None = None) -> object:
    """Return the multiprocessing context that starts new interpreters."""
    if method not in (None, "spawn"):
        raise ValueError(f"cannot find context for {method!r}")
    return multiprocessing.context.SpawnContext()


REPLACED: Mapping[str, Mapping[str, object]] = {
    "sys": {"platform": "win32"},
    "os": {
        "name": "nt",
        "supports_dir_fd": set(),
        "supports_follow_symlinks": {os.stat},
        "O_BINARY": 0,
        **{
            name: without_descriptors(name)
            for name in ("access", "link", "mkdir", "open", "rename", "replace", "rmdir", "stat", "unlink")
        },
    },
    "signal": {"SIGBREAK": signal.SIGUSR2},
    "select": {},
    "socket": {},
    "multiprocessing": {"get_all_start_methods": lambda: ["spawn"], "get_context": only_spawned},
    "multiprocessing.context": {},
    "multiprocessing.connection": {"PipeConnection": multiprocessing.connection.Connection},
}


class WindowsModule(ModuleType):
    """Module of the standard library as Windows has it."""

    def __init__(self, original: ModuleType) -> None:
        super().__init__(original.__name__)
        self.__dict__["_original"] = original

    def __getattr__(self, name: str) -> object:
        original: ModuleType = self.__dict__["_original"]
        key = original.__name__
        if name in MISSING_ATTRIBUTES.get(key, ()):
            raise AttributeError(f"module {key!r} has no attribute {name!r}")
        replaced = REPLACED[key]
        if name in replaced:
            return replaced[name]
        return STAND_INS.get(f"{key}.{name}") or getattr(original, name)

    def __setattr__(self, name: str, value: object) -> None:
        setattr(self.__dict__["_original"], name, value)


STAND_INS: dict[str, ModuleType] = {name: WindowsModule(sys.modules[name]) for name in REPLACED}
real_import = builtins.__import__


def import_as_on_windows(
    name: str,
    globals: Mapping[str, object] | None = None,
    locals: Mapping[str, object] | None = None,
    fromlist: tuple[str, ...] | None = (),
    level: int = 0,
) -> ModuleType:
    """Import a module, or its Windows replacement if kinesic imports the module."""
    caller = str((globals or {}).get("__name__", ""))
    program = str((globals or {}).get("__package__") or "")
    if not (caller.startswith("kinesic") or program.startswith("kinesic")):
        return real_import(name, globals, locals, fromlist, level)
    if name in MISSING_MODULES:
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)
    result = real_import(name, globals, locals, fromlist, level)
    return STAND_INS.get(result.__name__, result)


builtins.__import__ = import_as_on_windows
