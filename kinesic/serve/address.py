"""Host and port at which a server listens, without slow imports."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Address:
    """Listening address of a server."""

    host: str
    port: int  # 0: any free port

    def __str__(self) -> str:
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"
