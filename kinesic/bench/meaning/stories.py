"""Texts of three one-minute stories for measurements of gesture strokes."""

from collections.abc import Mapping

STORY_TEXTS: Mapping[str, str] = {
    "kitchen": (
        "I have to tell you what happened in our kitchen last night. We had invited eight people, and my wife "
        "wanted to make the big fish soup that her mother always makes. So in the afternoon I carried the huge pot "
        "up from the cellar, washed it, and put it on the stove. Everything was ready by six. The bread was warm, "
        "and the fish lay in a row on the table. Then the telephone rang. It was my sister, and she never stops. "
        "When I came back, the kitchen was full of smoke. The window was shut, the oil had caught fire, and our cat "
        "was sitting right beside it, quite calm, eating the second fish. I did not shout. I took a lid, pushed it "
        "over the pan, and waited. Slowly the flames became smaller and smaller, until nothing was left but a black "
        "ring on the wall. My wife came in, looked at the wall, looked at the cat, and looked at me. I thought she "
        "would be furious. But she opened the window, threw the pan into the garden, and began to laugh. In the end "
        "we all went down to the harbour and ate chips out of paper, and it was the best dinner we have had this "
        "year."
    ),
    "museum": (
        "Welcome to the old harbour museum. My name is Robin. Before we go in, let me tell you something about the "
        "house itself. It was built two hundred years ago, not as a museum but as a store for grain. If you look "
        "up, you can see the iron hook under the roof. With that hook, four men could lift a whole cart from the "
        "quay to the top floor. Inside there are three rooms. In the first room you will see tools and maps. Some "
        "of the maps are quite wrong: on one of them the island is twice as long as it really is, and the river "
        "flows in the opposite direction. The second room belongs to the fishermen. Please do not touch the nets "
        "there. And in the last room, at the end of the corridor, stands the thing that most people come for: a "
        "boat as tall as this door, carved out of a single tree. Nobody knows who made it. Some say it came across "
        "the sea, others say it never touched water at all. I have my own idea, but I would rather hear yours "
        "first. So come closer, mind the step, and ask me whatever you like. Is everybody here? Then let us begin."
    ),
    "bicycle": (
        "People often ask me why I ride to work every day, even when it rains. There are many reasons, but let me "
        "begin with the simple one. The train takes forty minutes, and you stand the whole way. On the bicycle I "
        "need half an hour, and nobody pushes me. Of course it was hard at first. On the hill behind the station I "
        "had to get off and walk, and old ladies overtook me on both sides. After a month I could ride up without "
        "stopping. What I like best is the morning. Between six and seven the streets are empty, the light is low, "
        "and a thin mist hangs over the canal. Once a heron flew beside me for a whole minute, so close that I "
        "could hear its wings. My colleagues think that I am crazy. On the one hand they may be right, because I "
        "have fallen twice and I have lost three lights. On the other hand I have not been ill for years, I sleep "
        "better, and I have saved a good deal of money. I do not want to persuade anybody. But if you have been "
        "thinking about it, do not think too long. Pump up the tyres, take a small bag, and just try it for a week."
    ),
}  # title of a story -> text
